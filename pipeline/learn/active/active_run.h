// A study that chooses its own trials: points, campaign, model, and again until the model is sure.
#pragma once
#include <filesystem>
#include <functional>

#include "pipeline/campaign/engine/study_campaign.h"

namespace gonogo::learn {

struct ActiveRequest {
  campaign::Study study;         // its design says which box is sampled; the points are chosen here
  std::filesystem::path folder;  // of the campaign; points.csv, the study with that table, and model.h5 are put there
  campaign::ComputeRequest compute;
  std::uint64_t seeds = 64;  // points of the first batch, uniform over the box
  std::uint64_t batch = 32;  // points of each further one
  std::uint64_t most_points = 1000;
  double confidence = 0.95;     // stop when the model expects to be right in this share of the box
  double space_filling = 0.25;  // share of each batch
};

struct ActiveSummary {
  campaign::CampaignSummary campaign;  // computed: by all batches of this call
  std::uint64_t points = 0;
  double confidence = 0;  // reached
  bool reached = false;
};

/// Continues where an earlier call ended. Throws InputError as plan_study_campaign and run_campaign.
ActiveSummary run_active(const ActiveRequest& request);

}  // namespace gonogo::learn
