// Files that are either whole or absent (write beside, fsync, rename), locks of folders, and hashes of content.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
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

/// One process at a time in a folder: holds <folder>/.lock while the object lives. The system frees it when the process
/// ends, also after a crash. Creates the folder. Throws InputError when another process holds the lock, DeviceError
/// when it cannot be taken.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  /// Nothing when another process holds the lock.
  static std::unique_ptr<FolderLock> if_free(const std::filesystem::path& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  struct Opened {
    int fd;
  };
  explicit FolderLock(Opened file) : fd_(file.fd) {}
  int fd_;
};

/// Content hash for caches and provenance (XXH3-128: fast, collision-free in practice, not cryptographic): 32
/// hexadecimal digits.
std::string content_hash(std::string_view content);

/// Hash of a file's content. Throws InputError when the file is missing or unreadable.
std::string file_hash(const std::filesystem::path& path);

}  // namespace gonogo
