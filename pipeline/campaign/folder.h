// The folder of a campaign: its lock, its record of what the trials depend on, its files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::pipeline {

using Dependencies = std::vector<std::pair<std::string, std::string>>;

std::filesystem::path journal_path(const std::filesystem::path& folder);
std::filesystem::path dataset_path(const std::filesystem::path& folder);
std::filesystem::path running_folder(const std::filesystem::path& folder);
/// Where a worker saves a trial that is under way.
std::filesystem::path saved_trial_path(const std::filesystem::path& running, std::uint64_t index);

/// Holds the folder for one coordinator. The system takes the lock back when the process ends, however it ends.
class FolderLock {
 public:
  /// Creates the folder. Throws InputError when another process holds it, DeviceError when it cannot be locked at all.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_ = -1;
};

bool is_locked(const std::filesystem::path& folder);

/// Writes campaign.json on the first run; later throws InputError naming each dependency that differs.
void claim_folder(const std::filesystem::path& folder, std::size_t trials, const Dependencies& depends_on);

/// Number of trials of the campaign in this folder; throws InputError when there is none.
std::size_t claimed_trials(const std::filesystem::path& folder);

/// Removes what a process killed while writing left beside its target. Needs the lock.
void remove_partial_files(const std::filesystem::path& folder);

}  // namespace gonogo::pipeline
