#include "pipeline/campaign/study_campaign.h"

#include <algorithm>
#include <memory>
#include <thread>

#include "pipeline/campaign/plan.h"
#include "pipeline/campaign/worker.h"
#include "pipeline/trial/trial.h"

namespace gonogo::pipeline {

CampaignRequest plan_study_campaign(const Study& study, const std::filesystem::path& folder, int workers) {
  const auto setup = std::make_shared<const TrialSetup>(read_trial_setup(study, default_packing_folder()));
  CampaignRequest request = plan_campaign(study, folder, workers, {{"calibration", setup->calibration_file}});
  const int threads = workers > 0 ? workers : int(std::max(1u, std::thread::hardware_concurrency()));
  request.prepare = [setup, design = request.design, threads] { prepare_trials(*setup, design, threads); };
  return request;
}

void run_study_worker(const std::filesystem::path& study_file) {
  const TrialSetup setup = read_trial_setup(read_study(study_file), default_packing_folder());
  run_worker([&setup](const DesignPoint& point) { return run_trial(setup, point); });
}

}  // namespace gonogo::pipeline
