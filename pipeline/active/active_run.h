// A study that chooses its own trials: points, campaign, model, and again until the model is sure.
#pragma once
#include <filesystem>
#include <functional>

#include "pipeline/campaign/study_campaign.h"

namespace gonogo::pipeline {

struct ActiveRequest {
  Study study;                   // its design has the method csv, with "ranges"; the file of points may not exist yet
  std::filesystem::path folder;  // of the campaign; model.h5 is put there
  ComputeRequest compute;
  std::uint64_t seeds = 64;  // points of the first batch, uniform over the box
  std::uint64_t batch = 32;  // points of each further one
  std::uint64_t most_points = 1000;
  double confidence = 0.95;     // stop when the model expects to be right in this share of the box
  double space_filling = 0.25;  // share of each batch
};

struct ActiveSummary {
  CampaignSummary campaign;
  std::uint64_t points = 0;
  double confidence = 0;  // reached
  bool reached = false;
};

/// Continues where an earlier call ended. Throws InputError for a study whose design is not such a table.
ActiveSummary run_active(const ActiveRequest& request);

}  // namespace gonogo::pipeline
