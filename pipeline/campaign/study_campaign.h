// A study's campaign of real trials: campaign.h bound to pipeline/trial.
#pragma once
#include <filesystem>

#include "pipeline/campaign/campaign.h"
#include "pipeline/study/study.h"

namespace gonogo::pipeline {

/// Simulates the study's missing trials in `workers` processes of one thread each (0: one per core) and writes
/// <folder>/dataset.h5. Beds that trials need are settled before, on `threads` threads (0: all cores). Throws as
/// read_trial_setup, plan_campaign and run_campaign do; the same call continues. Only for the program gonogo, whose
/// command "campaign worker" the workers run.
CampaignSummary run_study_campaign(const Study& study, const std::filesystem::path& folder, int workers, int threads);

/// What that command does: simulates the points that come by standard input.
void run_study_worker(const Study& study);

}  // namespace gonogo::pipeline
