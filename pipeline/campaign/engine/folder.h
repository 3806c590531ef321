// The folder of a campaign: its lock, its record of what the trials depend on, its files, its speed.
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/files/file.h"

namespace gonogo::campaign {

/// Finished trials of shards that are not committed yet: of the coordinator, and of a task that computes one shard.
std::filesystem::path journal_path(const std::filesystem::path& folder);
std::filesystem::path journal_path(const std::filesystem::path& folder, std::uint64_t shard);
/// Every journal there is, sorted.
std::vector<std::filesystem::path> journals_of(const std::filesystem::path& folder);
/// A dataset without trials, written when the campaign begins: its provenance.
std::filesystem::path origin_path(const std::filesystem::path& folder);
std::filesystem::path dataset_path(const std::filesystem::path& folder);
std::filesystem::path running_folder(const std::filesystem::path& folder);
/// CSV files of the trials' courses, where they are asked for.
std::filesystem::path course_folder(const std::filesystem::path& folder);
/// Where a worker saves a trial that is under way.
std::filesystem::path saved_trial_path(const std::filesystem::path& running, std::uint64_t index);

/// Who works in a campaign's folder: one coordinator, or any number of tasks of a batch system.
enum class FolderUse { none, tasks, coordinator };

FolderUse folder_use(const std::filesystem::path& folder);

struct ShardRange {
  std::uint64_t first = 0, count = 0;
};

/// How a design of `trials` points is cut into shards.
struct ShardPlan {
  std::uint64_t trials = 0, per_shard = 1;
  std::uint64_t count() const { return (trials + per_shard - 1) / per_shard; }
  std::uint64_t shard_of(std::uint64_t index) const { return index / per_shard; }
  ShardRange range(std::uint64_t shard) const {
    const std::uint64_t first = shard * per_shard;
    return {first, per_shard < trials - first ? per_shard : trials - first};
  }
};

using Dependencies = std::vector<std::pair<std::string, std::string>>;

/// A campaign's folder and its claim, held until this is destroyed or the process ends, however it ends; no clock is
/// involved.
struct HeldFolder {
  FileLock lock;
  ShardPlan plan;
};

/// For a coordinator. Creates the folder, writes campaign.json on the first run, and removes what killed processes
/// left. The shards' size is decided by the first run. Throws InputError when others hold the folder, and naming each
/// dependency that differs; DeviceError when the folder cannot be locked at all.
HeldFolder hold_folder(const std::filesystem::path& folder, const ShardPlan& wanted, const Dependencies& depends_on);

/// For work on a campaign that is claimed. Throws the same, and InputError when the folder holds another number of
/// trials than `trials`, or none.
HeldFolder hold_claimed_folder(const std::filesystem::path& folder, FolderUse use, std::uint64_t trials,
                               const Dependencies& depends_on);

/// The campaign of this folder; throws InputError when there is none.
ShardPlan read_claim(const std::filesystem::path& folder);

/// Speed of one writer, for other processes: a small file with a span of the writer's own clock, so that clocks of two
/// machines are never compared. Removed at the end. Failures are ignored: the file serves `campaign status` alone.
class PaceWriter {
 public:
  PaceWriter(const std::filesystem::path& folder, const std::string& writer);
  ~PaceWriter();
  PaceWriter(const PaceWriter&) = delete;
  PaceWriter& operator=(const PaceWriter&) = delete;

  void trial_done() { ++done_; }
  /// Writes at most every two seconds; call often.
  void tell_if_due();

 private:
  std::filesystem::path path_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point start_, last_;
};

/// Trials per second of all writers together [1/s]; 0 when there is none.
double total_pace(const std::filesystem::path& folder);

}  // namespace gonogo::campaign
