// Vehicle files by name.
#pragma once
#include <filesystem>
#include <string>

namespace gonogo::lab {

/// `name` is a file, or the name of one in configs/vehicles below the current folder or above the program. Throws
/// InputError with the names that there are.
std::filesystem::path vehicle_file(const std::string& name);

}  // namespace gonogo::lab
