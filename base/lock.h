// One process at a time in a folder.
#pragma once
#include <filesystem>

namespace gonogo {

/// Holds <folder>/.lock while the object lives. The system frees it when the process ends, also after a crash.
/// Creates the folder. Throws InputError when another process holds the lock, DeviceError when it cannot be taken.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_;
};

}  // namespace gonogo
