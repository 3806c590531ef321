// The folder of a campaign: its lock, its record of what the trials depend on, its files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/campaign/engine/file_lock.h"

namespace gonogo::campaign {

using Dependencies = std::vector<std::pair<std::string, std::string>>;

/// Finished trials of shards that are not committed yet: of the coordinator, and of a task that computes one shard.
std::filesystem::path journal_path(const std::filesystem::path& folder);
std::filesystem::path journal_path(const std::filesystem::path& folder, std::uint64_t shard);
/// Every journal there is, sorted.
std::vector<std::filesystem::path> journals_of(const std::filesystem::path& folder);
std::filesystem::path dataset_path(const std::filesystem::path& folder);
std::filesystem::path running_folder(const std::filesystem::path& folder);
/// Where a worker saves a trial that is under way.
std::filesystem::path saved_trial_path(const std::filesystem::path& running, std::uint64_t index);

/// Who works in a campaign's folder: one coordinator, or any number of tasks of a batch system.
enum class FolderUse { none, tasks, coordinator };

/// Holds the folder. The system takes the lock back when the process ends, however it ends; no clock is involved.
class CampaignLock {
 public:
  /// Creates the folder. Throws InputError when others hold it, DeviceError when it cannot be locked at all.
  CampaignLock(const std::filesystem::path& folder, FolderUse use);

 private:
  std::optional<FileLock> lock_;
};

FolderUse folder_use(const std::filesystem::path& folder);

struct Claim {
  std::size_t trials = 0;
  std::size_t trials_per_shard = 0;
};

/// Writes campaign.json on the first run; later throws InputError naming each dependency that differs. Returns what
/// holds now: the shards' size is decided by the first run.
Claim claim_folder(const std::filesystem::path& folder, const Claim& wanted, const Dependencies& depends_on);

/// The same for a task, which writes nothing: also throws when the folder holds another number of trials, or none.
Claim require_claim(const std::filesystem::path& folder, std::size_t trials, const Dependencies& depends_on);

/// The campaign of this folder; throws InputError when there is none.
Claim read_claim(const std::filesystem::path& folder);

/// Removes what a process killed while writing left beside its target. Needs the lock.
void remove_partial_files(const std::filesystem::path& folder);

}  // namespace gonogo::campaign
