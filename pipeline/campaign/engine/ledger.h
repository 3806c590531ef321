// Finished trials on disk: journals, shards, and the ledger of what is there.
//
// A journal is a text file that only grows, one line per trial:
//
//   <32 hexadecimal digits: content_hash of the row> <row as in pipeline/campaign/dataset/row.h>
//
// A trial is committed by one append. After kill -9 at any instant the file has whole lines and at most one torn last
// line, whose hash does not match. A power cut can take the lines of the last second. A campaign's folder holds one
// such file per engine or job in trials/. Rows stay there until their shard is committed.
//
// A campaign is cut into shards of equal numbers of trials, in the order of the design:
//
//   shards/shard-12.json    manifest: campaign, first trial, number, file with bytes and hash, counts by verdict
//   shards/shard-12.256.h5  a dataset (pipeline/campaign/dataset/dataset.h) of these trials
//
// The file is written beside, flushed and renamed. Writing the manifest in the same way then commits it. After a kill
// in between, the shard is not committed and its trials are still in the journals. A shard that grows gets another
// file, so that a manifest never names half of a change.
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/setup/record.h"

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

/// Replaces a journal by these rows, whole or not at all.
void write_journal(const std::filesystem::path& path, const std::vector<TrialRecord>& records);

class Journal {
 public:
  /// Opens for appending, in a folder that it makes; throws DeviceError when that is not permitted.
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

struct ShardManifest {
  ShardRange range;
  std::string campaign;  // hash of all that its trials depend on
  std::string file, hash;
  std::uint64_t bytes = 0;
  Counts by_verdict, by_reason;
};

std::filesystem::path shard_folder(const std::filesystem::path& folder);

/// `records` are trials first, first + 1, ... Throws DeviceError when the disk is full; nothing is committed then.
void commit_shard(const std::filesystem::path& folder, std::uint64_t shard, const std::vector<TrialRecord>& records,
                  const Provenance& provenance, const std::string& campaign);

/// Empty when the shard is not committed. Throws InputError for a manifest that cannot be read.
std::optional<ShardManifest> read_manifest(const std::filesystem::path& folder, std::uint64_t shard);

/// The shard's trials; empty when it is not committed. Throws InputError for a shard of another campaign, and when file
/// and manifest differ in length, hash, number or place of the trials.
std::optional<std::vector<TrialRecord>> read_shard(const std::filesystem::path& folder, std::uint64_t shard,
                                                   const std::string& campaign);

/// Which trials of a campaign are done, in committed shards and in journals of shards that are not whole yet.
class Ledger {
 public:
  /// Only `shards` are looked at. `request` must outlive it.
  Ledger(const CampaignRequest& request, ShardPlan plan, std::vector<std::uint64_t> shards);

  /// Reads committed shards and all journals, and commits shards that became whole. What cannot be read is set aside
  /// with a line on stderr: shards that do not match their manifest, and damaged lines of `own_journal`, which no other
  /// process uses; empty: of all journals. Throws InputError for trials at other points than the design's.
  void load(const std::filesystem::path& own_journal = {});

  std::vector<const DesignPoint*> missing() const;
  std::size_t done() const { return done_count_; }
  /// Unreadable lines and shards that were set aside.
  std::size_t damaged() const { return damaged_; }
  const Counts& by_verdict() const { return by_verdict_; }
  const Counts& by_reason() const { return by_reason_; }

  /// A trial that has just been written to a journal. Commits its shard when it is the last one of it.
  void add(TrialRecord record);

  /// Puts all rows that no committed shard holds into one journal, including rows beyond the end of a shortened design.
  void gather_journals() const;
  /// Reads every shard once more, against its manifest, and writes the dataset unless it is there already.
  void write_dataset() const;

 private:
  void load_shard(std::uint64_t shard);
  void load_journal(const std::filesystem::path& journal, bool repair);
  void check_point(const TrialRecord& record, const std::filesystem::path& file) const;
  void take(TrialRecord record);
  void commit_if_whole(std::uint64_t shard);

  const CampaignRequest& request_;
  ShardPlan plan_;
  std::string campaign_;  // hash of all that trials depend on
  std::vector<std::uint64_t> shards_;
  std::vector<bool> looked_at_, committed_;          // by shard
  std::vector<bool> done_;                           // by trial
  std::map<std::uint64_t, RecordsByIndex> pending_;  // by shard, of those not committed
  RecordsByIndex beyond_;                            // of a longer design in the same folder
  std::size_t done_count_ = 0, damaged_ = 0;
  Counts by_verdict_, by_reason_;
};

/// All shards, for the coordinator, who holds the folder: removes leftovers of killed processes, loads and repairs
/// every journal, and gathers them in one.
Ledger recovered_ledger(const CampaignRequest& request, ShardPlan plan);

}  // namespace gonogo::campaign
