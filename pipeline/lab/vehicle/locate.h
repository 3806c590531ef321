// Vehicle files by name.
#pragma once
#include <filesystem>
#include <string>

namespace gonogo::lab {

/// `name`: a file, or the name of one in configs/vehicles below the current folder or beside the program. Throws
/// InputError with the known names.
std::filesystem::path vehicle_file(const std::string& name);

}  // namespace gonogo::lab
