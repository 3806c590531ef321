// Trains a model on a dataset. Cross-validation chooses the number of epochs and scores the model on held-out folds.
// Then the final machine is trained on all trials.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/outcome/prior/vehicle_odds.h"
#include "pipeline/outcome/settings.h"
#include "pipeline/outcome/training/report.h"
#include "pipeline/outcome/training/teacher.h"

namespace gonogo::outcome {

struct TrainRequest {
  std::filesystem::path dataset;           // dataset.h5 of the fidelity that the model answers at
  std::filesystem::path model;             // model.h5 to write
  std::uint64_t seed = 1;                  // the study's
  std::optional<Config> learning = {};     // section of the study; none: defaults
  std::optional<Config> design = {};       // section of the study, for the sampled ranges; none: as the trials span
  std::size_t hold_out = 0;                // size of the held-out set, drawn from the seed; evaluate scores it
  std::vector<std::uint64_t> groups = {};  // of replicates: of those that are not held out these train; none: all
  std::vector<std::filesystem::path> others = {};  // datasets that the teacher learns, too (other_trials.h)
  std::shared_ptr<const Forecast> forecast = {};   // of the vehicle's family (teacher.h); nothing: none
  std::vector<VehicleTrials> vehicles = {};        // of a family, whose odds they calibrate (vehicle_odds.h)
  bool members_follow = false;  // train_members() comes next: finished folds are kept for its interruption
};

/// Takes seed, sections learning and design from a study file; `seed` wins over the study's. Without a file (empty
/// path) sections stay empty, and the seed is 1 unless given. Throws InputError as campaign::read_study().
void take_study(TrainRequest& request, const std::filesystem::path& study, std::optional<std::uint64_t> seed);

/// As read_learning_settings(). Also throws InputError for settings that LibTorch on this machine does not support.
LearningSettings trainable_settings(const std::optional<Config>& section);

/// Trains and writes the model, whose file holds the report, too. The same dataset, seed and settings give the same
/// bytes, for any number of threads. Throws InputError for a dataset without valid trials. Finished folds are kept in
/// <model>.unfinished, so the same call after an interruption continues with the next fold.
TrainingReport train_model(const TrainRequest& request);

/// Hash of everything that the machines of a request depend on: dataset, settings, seed, program.
std::string work_key(const TrainRequest& request, const LearningSettings& settings);

/// Trains `count` bootstrap members of a model, whose spread of answers measures the uncertainty that the trials leave.
/// Writes <model's stem>.member1.h5, ... beside the model, which must have been trained with the same request. Returns
/// the paths. After an interruption the same calls take finished members from disk. The same dataset, seed and settings
/// give the same bytes.
///
/// Bayesian bootstrap (Rubin 1981, Annals of Statistics 9, 130-134): every group of trials at one point gets a weight
/// drawn from the exponential distribution of mean 1. The machine is then trained again, with the same number of epochs
/// and the same calibration as the model.
std::vector<std::filesystem::path> train_members(const TrainRequest& request, int count);

}  // namespace gonogo::outcome
