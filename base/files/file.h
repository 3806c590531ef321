// Files that are either whole or absent (write beside, fsync, rename), locks, and hashes of content.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
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

/// A lock on a file, between processes and between the machines of a shared filesystem. Open file description locks
/// (fcntl): released by the system when the process ends, passed on by NFS and Lustre.
class FileLock {
 public:
  enum class Kind { shared, exclusive };

  FileLock() = default;
  ~FileLock();
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;

  /// Creates the file. Empty when another holds a lock that excludes this one. Throws InputError when the file cannot
  /// be written, DeviceError when its filesystem has no locks.
  static std::optional<FileLock> take(const std::filesystem::path& path, Kind kind);
  /// The lock that another process holds, if any. Takes none itself.
  static std::optional<Kind> held(const std::filesystem::path& path);

 private:
  int fd_ = -1;
};

/// One process at a time in a folder, which is made: locks <folder>/.lock. Empty when another process holds it.
std::optional<FileLock> lock_folder_if_free(const std::filesystem::path& folder);
/// The same; throws InputError when another process holds it.
FileLock lock_folder(const std::filesystem::path& folder);

/// Lets readers follow what a file names beyond itself: hosts, databases, bytes of other files. Off until called.
void allow_network();
bool network_allowed();

/// Content hash for caches and provenance (XXH3-128: fast, collision-free in practice, not cryptographic): 32
/// hexadecimal digits.
std::string content_hash(std::string_view content);

/// Hash of a file's content. Throws InputError when the file is missing or unreadable.
std::string file_hash(const std::filesystem::path& path);

}  // namespace gonogo
