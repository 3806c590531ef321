// The campaign of a study's trials: what the commands `campaign` and `run` share.
#pragma once
#include <filesystem>

#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/engine/compute.h"
#include "pipeline/campaign/engine/worker.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

/// Refuses a study whose campaign could not start: checks the sections vehicle, soil, trial and compute, where the
/// study has any of the first three. One with a design alone passes. Throws InputError.
void check_study(const Study& study);

/// plan_campaign() for real trials. Checks the sections vehicle, soil, trial and compute. Results also depend on the
/// calibration file and the device. `prepare` settles the beds of missing trials on the host before workers start.
/// Throws InputError.
CampaignRequest plan_study_campaign(const Study& study, const std::filesystem::path& folder,
                                    const ComputeRequest& asked);

struct WorkerOptions {
  sim::Backend device = sim::Backend::cpu;
  int places = 1;
  int gpu = 0;                        // of this machine, for the device cuda
  std::filesystem::path checkpoints;  // folder; empty: trials are not saved
  double checkpoint_every = 30;       // [s]
};

/// Computes trials of the study until `line`, or standard input, ends. A trial with a saved state goes on from there. A
/// saved state that cannot be used is set aside.
void run_study_worker(const std::filesystem::path& study_file, const WorkerOptions& options);
void run_study_worker(const Study& study, const WorkerOptions& options, WorkerLine& line);

/// Options of the `worker`-th worker, for engines that pass no command line.
WorkerOptions worker_options(const Study& study, const std::filesystem::path& folder, const ComputeRequest& asked,
                             int worker);

}  // namespace gonogo::campaign
