// A lock on a file, between processes and between the machines of a shared filesystem.
#pragma once
#include <filesystem>
#include <optional>

namespace gonogo::campaign {

/// Open file description locks (fcntl): released by the system when the process ends, passed on by NFS and Lustre.
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

}  // namespace gonogo::campaign
