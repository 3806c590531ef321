// Which trials of a campaign are done, in committed shards and in journals of shards that are not whole yet.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "pipeline/campaign/engine/journal.h"
#include "pipeline/campaign/engine/shard.h"

namespace gonogo::campaign {

class Ledger {
 public:
  /// `design` must outlive it; only `shards` are looked at. `campaign`: hash of all that trials depend on.
  Ledger(std::filesystem::path folder, const std::vector<DesignPoint>& design, ShardPlan plan, Provenance provenance,
         std::string campaign, std::vector<std::uint64_t> shards);

  /// Reads committed shards. One that cannot be read, or does not match its manifest, is set aside with a line on
  /// stderr. Throws InputError for trials at other points than the design's.
  void load_shards();
  /// Takes rows of a journal. `repair` sets damaged lines aside, with a line on stderr; no other process may use the
  /// journal then. Throws as above.
  void load_journal(const std::filesystem::path& journal, bool repair);

  std::vector<const DesignPoint*> missing() const;
  std::size_t done() const { return done_count_; }
  /// Unreadable lines and shards that were set aside.
  std::size_t damaged() const { return damaged_; }
  const Counts& by_verdict() const { return by_verdict_; }
  const Counts& by_reason() const { return by_reason_; }

  /// A trial that has just been written to a journal. Commits its shard when it is the last one of it.
  void add(TrialRecord record);
  /// Commits shards that became whole by loading.
  void commit_whole();

  /// Rows of journals that no committed shard holds, including rows beyond the end of a shortened design.
  std::vector<TrialRecord> uncommitted() const;

 private:
  void load_shard(std::uint64_t shard);
  void check_point(const TrialRecord& record, const std::filesystem::path& file) const;
  void take(TrialRecord record);
  void commit(std::uint64_t shard);

  std::filesystem::path folder_;
  const std::vector<DesignPoint>& design_;
  ShardPlan plan_;
  Provenance provenance_;
  std::string campaign_;
  std::vector<std::uint64_t> shards_;
  std::vector<bool> looked_at_, committed_;          // by shard
  std::vector<bool> done_;                           // by trial
  std::map<std::uint64_t, RecordsByIndex> pending_;  // by shard, of those not committed
  RecordsByIndex beyond_;                            // of a longer design in the same folder
  std::size_t done_count_ = 0, damaged_ = 0;
  Counts by_verdict_, by_reason_;
};

}  // namespace gonogo::campaign
