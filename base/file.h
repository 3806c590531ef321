// Files that are either whole or absent: write beside, fsync, rename.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace gonogo {

/// Reads a whole file. Throws InputError naming the path when it is missing or unreadable.
std::string read_file(const std::filesystem::path& path);

/// Writes `content` so that `path` holds either its old content or all of the new one, also after kill -9 or a full
/// disk. Creates parent folders. Throws DeviceError naming the path and the system's reason; the partial file is
/// removed.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Same promise for libraries that write files themselves: `write(temporary)` fills the temporary file beside `path`
/// (same folder and extension), which is then flushed to disk and renamed. On an exception the temporary is removed.
void replace_file_atomically(const std::filesystem::path& path,
                             const std::function<void(const std::filesystem::path& temporary)>& write);

/// Creates the folder (and its parents); throws InputError when that is not permitted or a file stands in the way.
void create_folder(const std::filesystem::path& folder);

}  // namespace gonogo
