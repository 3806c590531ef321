// From a study to its campaign: the design, and all that the trials' bits depend on.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

/// Files that trials read, by name ("vehicle" is added by itself when the study has one).
using InputFiles = std::vector<std::pair<std::string, std::filesystem::path>>;

/// Release and revision of this program, as provenance names it.
std::string campaign_program();

/// A CampaignRequest without `prepare`. Workers are this program with "campaign worker <study>". Trials depend on
///   - the study's seed and its sections soil, trial and design, without the number of points;
///   - the content of `inputs`, and `backend` ("cpu", or "cuda" and the device's name);
///   - contract, program and compiler.
/// The rest of the study, and the number of points, may change between runs. Throws InputError for a bad design section
/// or a missing file.
CampaignRequest plan_campaign(const Study& study, const std::filesystem::path& folder, int workers,
                              const InputFiles& inputs = {}, const std::string& backend = "cpu");

}  // namespace gonogo::campaign
