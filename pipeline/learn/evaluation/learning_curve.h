// How the scores of model and baselines fall with the number of trials that they are trained on.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/learn/training/train_model.h"

namespace gonogo::learn {

struct LearningCurveRequest {
  TrainRequest training;            // its `hold_out` trials score every model; its `model` is set here
  std::vector<std::size_t> trials;  // numbers to train on, taken from those that are not held out
  std::size_t subsets = 5;          // of each number, drawn by their own number; all trials are one subset
  bool active = false;              // the smallest number is drawn, the next ones follow its models: grown_groups()
  std::filesystem::path folder;     // models, scores and learning_curve.json
};

/// Trains one model for each number and subset and scores it on the held-out trials beside its baselines, which are
/// trained on the same trials. Model and scores of each lie in <folder>/trials_N_subset_K, and a call with the same
/// inputs reuses them. Processes that are started with the same inputs and folder share the work: each takes the next
/// model that nobody has. The result, also in <folder>/learning_curve.json, holds what was there when this call ended:
/// { "key", "held_out", "points": [{ "trials", "subset", "brier": {name: x}, "log_loss_nat": {name: x} }],
/// "elsewhere": models that other processes were training }. Throws InputError for a number that exceeds the trials
/// left, and for no number or no held-out trials.
Json learning_curve(const LearningCurveRequest& request);

/// Means over the subsets, and which forecaster is best, as a table for people.
std::string learning_curve_text(const Json& curve);

/// learning_curve.csv and, in a build with pictures, learning_curve.png in the folder. Returns the files.
std::vector<std::filesystem::path> write_learning_curve(const std::filesystem::path& folder, const Json& curve);

}  // namespace gonogo::learn
