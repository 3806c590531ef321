// The campaign of a study's trials: what the commands `campaign` and `run` share.
#pragma once
#include <filesystem>

#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/engine/compute.h"
#include "pipeline/campaign/engine/worker.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

/// plan_campaign() for real trials: checks vehicle, soil, trial and compute sections, lets results depend on the
/// calibration file and the device, and settles the beds that missing trials need, on the host, before workers start.
/// Throws InputError.
CampaignRequest plan_study_campaign(const Study& study, const std::filesystem::path& folder,
                                    const ComputeRequest& compute);

struct WorkerOptions {
  sim::Backend device = sim::Backend::cpu;
  int places = 1;
  int gpu = 0;                        // of this machine, for the device cuda
  std::filesystem::path checkpoints;  // folder; empty: trials are not saved
  double checkpoint_every = 30;       // [s]
};

/// The worker's half: computes trials of the study until `line` ends, or standard input does. A trial of which a saved
/// state is found goes on from there; a saved state that cannot be used is set aside.
void run_study_worker(const std::filesystem::path& study_file, const WorkerOptions& options);
void run_study_worker(const Study& study, const WorkerOptions& options, WorkerLine& line);

/// Options of the `worker`-th worker of a campaign that has not the words of a command line to tell them.
WorkerOptions worker_options(const Study& study, const std::filesystem::path& folder, const ComputeRequest& compute,
                             int worker);

}  // namespace gonogo::campaign
