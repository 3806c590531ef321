// One process at a time in a folder.
#pragma once
#include <filesystem>

namespace gonogo {

/// Holds <folder>/.lock for the life of the object; the system frees it when the process ends, however it ends.
/// The folder is created. Throws InputError when another process holds it, DeviceError when it cannot be taken.
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
