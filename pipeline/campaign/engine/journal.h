// Finished trials on disk: a text file that only grows, one line per trial.
//
//   <32 hexadecimal digits: content_hash of the row> <row as in pipeline/campaign/dataset/row.h>
//
// A trial is committed by one append. After kill -9 at any instant the file has whole lines and at most one torn last
// line, whose hash does not match. A power cut can take the lines of the last second. A campaign's folder holds one
// such file per engine or job in trials/. Rows stay there until their shard is committed.
#pragma once
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/campaign/trial/record.h"

namespace gonogo::campaign {

/// "<hash> <text>\n"; the text has no line ends.
std::string seal_line(std::string_view text);
/// The text of a line without its end; empty when the hash does not match.
std::optional<std::string_view> unseal_line(std::string_view line);

using RecordsByIndex = std::map<std::uint64_t, TrialRecord>;

struct JournalContent {
  RecordsByIndex records;
  std::string intact;   // the lines worth keeping
  std::string damaged;  // the rest
  std::size_t damaged_count = 0;
};

/// Reads a journal without touching it; a missing file is empty. A row that repeats one is dropped. Throws InputError
/// for an unreadable file and when one trial has two different results.
JournalContent read_journal(const std::filesystem::path& path);

/// As read_journal, and moves damaged lines to "<journal>.damaged", so that their trials are computed again.
JournalContent recover_journal(const std::filesystem::path& path);

/// Replaces a journal by these rows, whole or not at all.
void write_journal(const std::filesystem::path& path, const std::vector<TrialRecord>& records);

class Journal {
 public:
  /// Opens for appending; throws DeviceError when that is not permitted.
  explicit Journal(const std::filesystem::path& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Commits one trial. Throws DeviceError (disk full) and takes back what was written of the line.
  void append(const TrialRecord& record);
  /// Flushes to the disk what is older than a second; call often.
  void flush_if_due();
  void flush();

 private:
  void append_line(const std::string& line);

  std::filesystem::path path_;
  int fd_ = -1;
  bool dirty_ = false;
  std::chrono::steady_clock::time_point last_flush_;
};

}  // namespace gonogo::campaign
