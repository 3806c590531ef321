#include "pipeline/campaign/study_campaign.h"

#include <algorithm>
#include <thread>

#include "pipeline/campaign/plan.h"
#include "pipeline/campaign/worker.h"
#include "pipeline/trial/trial.h"

namespace gonogo::pipeline {

CampaignSummary run_study_campaign(const Study& study, const std::filesystem::path& folder, int workers, int threads) {
  const TrialSetup setup = read_trial_setup(study);
  CampaignRequest request = plan_campaign(study, folder, workers, {{"soil calibration", setup.calibration_file}});
  const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
  request.prepare = [&] { prepare_trials(setup, request.design, threads > 0 ? threads : cores); };
  return run_campaign(request);
}

void run_study_worker(const Study& study) {
  const TrialSetup setup = read_trial_setup(study);
  run_worker([&setup](const DesignPoint& point) { return run_trial(setup, point); });
}

}  // namespace gonogo::pipeline
