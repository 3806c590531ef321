// A file of numbered records that only grows: what was appended before a crash is found again, a torn end is cut off.
// Each record carries a checksum, so that a power cut that reorders writes shows, too.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace gonogo {

class RecordLog {
 public:
  /// Opens `path` for appending. Records of an earlier run are kept when the file was opened with the same `key`,
  /// otherwise it starts empty. Throws DeviceError when the system refuses.
  RecordLog(std::filesystem::path path, const std::string& key);
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;
  ~RecordLog();

  /// Thread-safe. A later record of the same number takes the place of the earlier one.
  void append(std::uint32_t number, std::string_view content);
  bool has(std::uint32_t number) const;
  std::size_t size_of(std::uint32_t number) const;
  /// Throws DeviceError when there is none or the disk refuses. Thread-safe.
  std::string read(std::uint32_t number) const;

  const std::filesystem::path& path() const { return path_; }
  /// Closes and deletes the file.
  void remove();

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t size = 0;
  };
  void find_records();
  bool read_at(std::uint64_t offset, void* to, std::size_t size) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t end_ = 0;
  std::map<std::uint32_t, Place> place_;
  mutable std::mutex mutex_;
};

}  // namespace gonogo
