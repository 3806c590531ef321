// How the scores of model and baselines fall with the number of trials that they are trained on.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/training.h"
#include "pipeline/outcome/active/choose.h"
#include "pipeline/outcome/training/train_model.h"

namespace gonogo::outcome {

struct LearningCurveRequest {
  TrainRequest training;            // its `hold_out` trials score every model; its `model` is set here
  std::vector<std::size_t> trials;  // numbers to train on, taken from those that are not held out
  std::size_t subsets = 5;          // of each number, drawn by their own number; all trials are one subset
  /// The smallest number is drawn, evenly or from the forecast of `training`; the next ones follow its models:
  /// grown_groups().
  bool active = false;
  std::filesystem::path folder;  // models, scores and learning_curve.json
};

/// Scores of one model and its baselines on the held-out trials, by the name of the forecaster.
struct CurvePoint {
  std::size_t trials = 0, subset = 0;
  std::map<std::string, double> brier, log_loss;  // log loss [nat]
};

struct LearningCurve {
  std::string key;  // hash of everything that the models depend on
  std::size_t held_out = 0;
  std::vector<CurvePoint> points;
  std::size_t elsewhere = 0;  // models that other processes were training
};

/// Trains one model for each number and subset and scores it on the held-out trials beside its baselines, which are
/// trained on the same trials. Model and scores of each lie in <folder>/trials_N_subset_K, and a call with the same
/// inputs reuses them. Processes that are started with the same inputs and folder share the work: each takes the next
/// model that nobody has. The result, also in <folder>/learning_curve.json, holds what was there when this call ended.
/// Throws InputError for a number that exceeds the trials left, and for no number or no held-out trials.
LearningCurve learning_curve(const LearningCurveRequest& request);

Json to_json(const LearningCurve& curve);
/// Means over the subsets, and which forecaster is best, as a table for people.
std::string learning_curve_text(const LearningCurve& curve);

/// learning_curve.csv and, in a build with pictures, learning_curve.png in the folder. Returns the files.
std::vector<std::filesystem::path> write_learning_curve(const std::filesystem::path& folder,
                                                        const LearningCurve& curve);

/// Groups of replicates that an active design takes from the table: `taken` and, drawn one after the other from the
/// rest, as many as it needs for `count` rows or a few more. A group's chance is in proportion to the density of
/// choose_batch() at its point, by `model`, with its default share of space filling. Ascending.
std::vector<std::uint64_t> grown_groups(const learning::TrainingTable& table, const std::vector<std::uint64_t>& taken,
                                        std::size_t count, const ModelAnswers& model, std::uint64_t seed);

}  // namespace gonogo::outcome
