// An append-only file of numbered records that survives crashes. An incomplete last record is cut off.
// Each record has a checksum, which detects writes that a power cut reordered.
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
  /// Opens `path` for appending. Keeps the records of an earlier run with the same `key`; otherwise starts empty.
  /// Throws DeviceError when the file cannot be opened.
  RecordLog(std::filesystem::path path, const std::string& key);
  RecordLog(const RecordLog&) = delete;
  RecordLog& operator=(const RecordLog&) = delete;
  ~RecordLog();

  /// A later record replaces an earlier one of the same number. Thread-safe.
  void append(std::uint32_t number, std::string_view content);
  bool has(std::uint32_t number) const;
  std::size_t size_of(std::uint32_t number) const;
  /// Throws DeviceError when there is no such record or it cannot be read. Thread-safe.
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
