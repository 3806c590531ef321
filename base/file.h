// Files that are either whole or absent: write beside, fsync, rename.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace gonogo {

/// Reads a whole file. Throws InputError naming the path when it is missing or unreadable.
std::string read_file(const std::filesystem::path& path);

/// Replaces `path` as a whole: after kill -9 or a full disk it holds the old content or the new, never a part.
/// Creates parent folders. Throws DeviceError naming path and reason, and removes the partial file.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// The same for libraries that write files themselves. `write(temporary)` fills a file beside `path` with the same
/// extension, which is then flushed and renamed. An exception removes it.
void replace_file_atomically(const std::filesystem::path& path,
                             const std::function<void(const std::filesystem::path& temporary)>& write);

/// Creates the folder and its parents. Throws InputError when that is not permitted or a file has the name.
void create_folder(const std::filesystem::path& folder);

}  // namespace gonogo
