// Trains a model on a dataset. Cross-validation chooses the number of epochs and scores the model on held-out folds.
// Then the final machine is trained on all trials.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/learn/training/settings.h"
#include "pipeline/learn/training/training_data.h"

namespace gonogo::learn {

struct TrainRequest {
  std::filesystem::path dataset;           // dataset.h5 of the fidelity that the model answers at
  std::filesystem::path model;             // model.h5 to write
  std::uint64_t seed = 0;                  // the study's
  std::optional<Config> learning;          // section of the study; none: defaults
  std::optional<Config> design;            // section of the study, for the sampled ranges; none: as the trials span
  std::size_t hold_out = 0;                // size of the held-out set, drawn from the seed; evaluate scores it
  std::vector<std::uint64_t> groups = {};  // of replicates: of those that are not held out these train; none: all
  std::vector<std::filesystem::path> others = {};  // datasets of other fidelities (other_fidelity.h)
  bool members_follow = false;  // train_members() comes next: finished folds are kept for its interruption
};

/// As read_learning_settings(). Also throws InputError for settings that LibTorch on this machine does not support.
LearningSettings trainable_settings(const std::optional<Config>& section);

/// Trains and writes the model. Returns the report that the model file also holds. The same dataset, seed and settings
/// give the same bytes, for any number of threads. Throws InputError for a dataset without valid trials. Finished folds
/// are kept in <model>.unfinished, so the same call after an interruption continues with the next fold.
Json train_model(const TrainRequest& request);

/// Hash of everything that the machines of a request depend on: dataset, settings, seed, program.
std::string work_key(const TrainRequest& request, const LearningSettings& settings);

/// The report as text for people: trial counts, failure rate, and cross-validated scores of model and baselines.
std::string report_text(const Json& report);

}  // namespace gonogo::learn
