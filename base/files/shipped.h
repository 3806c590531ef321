// Files that ship with the program, by name: configs/<kind>/<name>.json and the folders data/<name>.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo {

/// The folders of this kind that exist, first one first: configs/<kind> here, in $GONOGO_SHARE, and above the running
/// program: in its source tree or under share/gonogo of the prefix it is installed in.
std::vector<std::filesystem::path> shipped_folders(const std::string& kind);

/// The folders data/<name> that hold this file, sorted by name. They are sought in the same places; of two folders of
/// one name the first counts.
std::vector<std::filesystem::path> shipped_data_folders(const std::string& file);

/// Sorted names of the JSON files in a folder, without those that begin with `left_out`.
std::vector<std::string> shipped_names(const std::filesystem::path& folder, const std::string& left_out = {});

/// The file `name`, or <name>.json of shipped_folders(kind). Throws InputError that calls it a `what` and lists the
/// names there are.
std::filesystem::path shipped_file(const std::string& kind, const std::string& what, const std::string& name,
                                   const std::string& left_out = {});

}  // namespace gonogo
