// A study's campaign of real trials: campaign.h bound to pipeline/trial.
#pragma once
#include <filesystem>

#include "pipeline/campaign/campaign.h"
#include "pipeline/study/study.h"

namespace gonogo::pipeline {

/// The campaign of the study's trials, ready for run_campaign: `workers` processes of one thread each (0: one per
/// core); the beds that trials need are settled before, on `threads` threads (0: all cores). Trials depend on the soil
/// calibration's content too. Throws as read_trial_setup and plan_campaign do, and writes nothing. Only for the program
/// gonogo, whose command "campaign worker" the workers run.
CampaignRequest plan_study_campaign(const Study& study, const std::filesystem::path& folder, int workers, int threads);

/// What that command does: simulates the points that come by standard input.
void run_study_worker(const Study& study);

}  // namespace gonogo::pipeline
