#include "pipeline/campaign/study_campaign.h"

#include <algorithm>
#include <thread>

#include "pipeline/campaign/plan.h"
#include "pipeline/campaign/worker.h"
#include "pipeline/trial/trial.h"

namespace gonogo::pipeline {

CampaignRequest plan_study_campaign(const Study& study, const std::filesystem::path& folder, int workers, int threads) {
  const TrialSetup setup = read_trial_setup(study);
  CampaignRequest request = plan_campaign(study, folder, workers, {{"soil calibration", setup.calibration_file}});
  const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
  request.prepare = [setup, design = request.design, threads = threads > 0 ? threads : cores] {
    prepare_trials(setup, design, threads);
  };
  return request;
}

void run_study_worker(const Study& study) {
  const TrialSetup setup = read_trial_setup(study);
  run_worker([&setup](const DesignPoint& point) { return run_trial(setup, point); });
}

}  // namespace gonogo::pipeline
