// Files that ship with the program, by name: configs/<kind>/<name>.json.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo {

/// The folders configs/<kind> that there are: here, or beside the source tree that the program was built in.
std::vector<std::filesystem::path> shipped_folders(const std::string& kind);

/// Names of the JSON files in a folder, ascending, but for those that begin with `left_out`.
std::vector<std::string> shipped_names(const std::filesystem::path& folder, const std::string& left_out = {});

/// `name` is a file, or the name of one in shipped_folders(kind). Throws InputError that calls it a `what` and lists
/// the names there are.
std::filesystem::path shipped_file(const std::string& kind, const std::string& what, const std::string& name,
                                   const std::string& left_out = {});

}  // namespace gonogo
