// An active study: it chooses points, runs their trials and trains a model, and repeats until the model is confident.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/outcome/prior/forecast.h"

namespace gonogo::outcome {

struct ActiveRequest {
  campaign::Study study;         // its design gives the sampled box; its points are replaced
  std::filesystem::path folder;  // of the campaign; gets points.csv, the study with that table, and model.h5
  campaign::ComputeRequest compute;
  std::uint64_t seeds = 64;         // points of the first batch, uniform over the box without a forecast
  std::uint64_t batch = 32;         // points of every further batch
  std::uint64_t max_points = 1000;  // max number of points in all batches
  double confidence = 0.95;         // stop when the model expects to be right in this share of the box [0, 1]
  /// Of the vehicle's family; nothing: none. The first batch is then drawn as the further ones are, from this forecast,
  /// and every model starts from it.
  std::shared_ptr<const Forecast> forecast = {};
  double space_filling = 0.25;  // share of every batch that is uniform over the box [0, 1]
};

struct ActiveSummary {
  campaign::CampaignSummary campaign;  // `computed` counts the trials of all batches of this call
  std::uint64_t points = 0;            // in the table, with those of earlier calls
  double confidence = 0;               // of the last model: 1 - expected_error()
  bool reached = false;                // `confidence` of the request was reached
};

/// Runs the study. Continues where an earlier call in the same folder ended. Throws InputError as plan_study_campaign()
/// and run_campaign() do.
ActiveSummary run_active(const ActiveRequest& request);

}  // namespace gonogo::outcome
