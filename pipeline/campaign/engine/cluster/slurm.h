// The Slurm engine: a job array whose tasks compute the shards of a campaign. Slurm does the scheduling.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/campaign/engine/campaign.h"

namespace gonogo::campaign {

struct SlurmRequest {
  int tasks = 0;                          // of the array at most; 0: one per shard, at most 1000
  std::vector<std::string> task_command;  // computes task $SLURM_ARRAY_TASK_ID of the array
  std::vector<std::string> options;       // further options of sbatch, "--time=2:00:00"
};

struct Submission {
  std::string job;  // Slurm's number; empty when no trial was missing
  std::size_t shards = 0, tasks = 0;
  std::filesystem::path script;
};

/// Claims the folder, writes <folder>/slurm/job.sh and gives it to sbatch. The script calls `task_command` with "--task
/// <this one's number> --tasks <of how many>". Committed shards are left out: submitting again computes what is
/// missing. Throws InputError when tasks are at work there, DeviceError with Slurm's words when sbatch refuses or is
/// not installed.
Submission submit_campaign(const CampaignRequest& campaign, const SlurmRequest& slurm);

/// "job 12: 3 running, 1 pending": Slurm's states of the unfinished jobs submitted from this folder. Empty when there
/// are none, or no Slurm.
std::string slurm_state(const std::filesystem::path& folder);

}  // namespace gonogo::campaign
