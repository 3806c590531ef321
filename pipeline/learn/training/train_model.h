// From a dataset to a model file: cross-validation chooses the number of epochs and scores the model on trials it did
// not see, then all trials train the final machine.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "base/json/config.h"
#include "pipeline/learn/training/settings.h"
#include "pipeline/learn/training/training_data.h"

namespace gonogo::learn {

struct TrainRequest {
  std::filesystem::path dataset;   // dataset.h5
  std::filesystem::path model;     // model.h5 to write
  std::uint64_t seed = 0;          // the study's
  std::optional<Config> learning;  // section of the study; nothing: defaults
  std::optional<Config> design;    // section of the study, for the sampled ranges; nothing: what the trials span
  std::size_t hold_out = 0;        // valid trials that are not trained on, drawn from the seed; evaluate scores them
};

/// read_learning_settings(), and throws InputError for what this LibTorch on this machine cannot do.
LearningSettings trainable_settings(const std::optional<Config>& section);

/// Trains and writes the model. Returns the report that the model file also holds (see report_text). Same dataset, seed
/// and settings: same bytes, for any number of threads. Throws InputError for a dataset without valid trials.
Json train_model(const TrainRequest& request);

/// Trial counts, failure rate, and scores of P(go) by cross-validation beside logistic regression and the base rate.
std::string report_text(const Json& report);

}  // namespace gonogo::learn
