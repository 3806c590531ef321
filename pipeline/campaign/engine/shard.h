// Committed trials: a campaign is cut into shards of equal numbers of trials, in the order of the design.
//
//   shards/shard-12.json    manifest: campaign, first trial, number, file with bytes and hash, counts by verdict
//   shards/shard-12.256.h5  a dataset (pipeline/campaign/dataset/dataset.h) of these trials
//
// The file is written beside, flushed and renamed. Writing the manifest in the same way then commits it. After a kill
// in between, the shard is not committed and its trials are still in the journals. A shard that grows gets another
// file, so that a manifest never names half of a change.
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

struct ShardRange {
  std::uint64_t first = 0, count = 0;
};

/// How a design of `trials` points is cut.
struct ShardPlan {
  std::uint64_t trials = 0, per_shard = 1;
  std::uint64_t count() const { return (trials + per_shard - 1) / per_shard; }
  std::uint64_t shard_of(std::uint64_t index) const { return index / per_shard; }
  ShardRange range(std::uint64_t shard) const {
    const std::uint64_t first = shard * per_shard;
    return {first, std::min(per_shard, trials - first)};
  }
};

using Counts = std::map<std::string, std::size_t>;
void count_outcome(const TrialRecord& record, Counts& by_verdict, Counts& by_reason);

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

/// Renames manifest and file to *.damaged, so that the shard is not committed any more.
void set_shard_aside(const std::filesystem::path& folder, std::uint64_t shard);

}  // namespace gonogo::campaign
