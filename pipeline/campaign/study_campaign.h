// The campaign of a study's trials: what the commands `campaign` and `run` share.
#pragma once
#include <filesystem>

#include "pipeline/campaign/campaign.h"
#include "pipeline/study/study.h"

namespace gonogo::pipeline {

/// plan_campaign() for real trials: checks vehicle, soil and trial sections, lets results depend on the calibration
/// file, and settles the beds that missing trials need before workers start. Throws InputError.
CampaignRequest plan_study_campaign(const Study& study, const std::filesystem::path& folder, int workers);

/// The worker's half: computes trials of the study until standard input ends.
void run_study_worker(const std::filesystem::path& study_file);

}  // namespace gonogo::pipeline
