// What the commands of campaigns print.
#pragma once
#include <map>
#include <string>

#include "base/json/json.h"
#include "pipeline/campaign/engine/campaign.h"

namespace gonogo::app {

/// An object of numbers by name.
Json counts_json(const std::map<std::string, std::size_t>& counts);

Json campaign_json(const campaign::CampaignSummary& summary);
std::string campaign_text(const campaign::CampaignSummary& summary);

}  // namespace gonogo::app
