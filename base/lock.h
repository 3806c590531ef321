// One process at a time in a folder.
#pragma once
#include <filesystem>
#include <memory>

namespace gonogo {

/// Holds <folder>/.lock while the object lives. The system frees it when the process ends, also after a crash.
/// Creates the folder. Throws InputError when another process holds the lock, DeviceError when it cannot be taken.
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

}  // namespace gonogo
