// The campaign of a study's trials: its design, what the bits of trials depend on, where they are computed, and one
// trial repeated from its dataset.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/campaign/dataset/check.h"
#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/engine/worker.h"
#include "pipeline/campaign/study/study.h"
#include "sim/simulation/simulation.h"

namespace gonogo::campaign {

/// Files that trials read, by name ("vehicle" is added by itself when the study has one).
using InputFiles = std::vector<std::pair<std::string, std::filesystem::path>>;

/// A CampaignRequest without `prepare`. Workers are this program with "campaign worker <study>". Trials depend on
///   - the study's seed and its sections soil, trial and design, without the number of points;
///   - the content of `inputs`, and `backend` ("cpu", or "cuda" and the device's name);
///   - contract, program and compiler.
/// The rest of the study, and the number of points, may change between runs. Throws InputError for a bad design section
/// or a missing file.
CampaignRequest plan_campaign(const Study& study, const std::filesystem::path& folder, int workers,
                              const InputFiles& inputs = {}, const std::string& backend = "cpu");

/// Where a campaign computes its trials: the command line's part, which overrides the study's section "compute".
struct ComputeRequest {
  std::optional<std::string> device;  // "cpu" or "cuda"
  std::optional<int> places, workers;
  std::optional<int> gpus;                 // that the workers share; all without a number. Means device "cuda"
  std::optional<double> checkpoint_every;  // [s]
  std::optional<double> course_every;      // simulated time between two lines of a trial's course [s]; 0: none
  int threads = 0;                         // 0: one per core
};

/// The first `count` GPUs of a machine with these names, or all; they must be alike, because bits are the same on one
/// kind of device. Throws InputError.
std::vector<std::string> alike_gpus(std::vector<std::string> names, std::optional<int> count);

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
  std::filesystem::path courses;      // folder; empty: courses of trials are not written
  double course_every = 0.05;         // simulated time between two of their lines [s]
};

/// Computes trials of the study until `line`, or without one standard input, ends. A trial with a saved state goes on
/// from there. A saved state that cannot be used is set aside.
void run_study_worker(const Study& study, const WorkerOptions& options, WorkerLine* line = nullptr);

/// Options of the `worker`-th worker, for engines that pass no command line.
WorkerOptions worker_options(const Study& study, const std::filesystem::path& folder, const ComputeRequest& asked,
                             int worker);

/// One trial of a dataset, repeated from the dataset alone.
struct Replay {
  TrialRecord record;
  std::vector<RowDifference> differences;  // of the record against the dataset's, bit for bit
  bool same_program = true;                // as the one that made the dataset
};

/// Writes the stored study, vehicle and soil to a temporary folder, settles the bed and computes the trial on the
/// dataset's kind of device. Throws InputError for a trial that is not there and for a device that this machine lacks.
/// Datasets made before input files were stored cannot be replayed and throw InputError too.
Replay replay_trial(const Dataset& dataset, std::uint64_t index, int threads);

}  // namespace gonogo::campaign
