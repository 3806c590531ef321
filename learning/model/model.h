// A trained model and its file. model.h5 holds weights, biases, the layout as JSON, the training points and log, and
// everything needed to say where it came from.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "learning/encoding/layout.h"
#include "learning/model/posterior.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

struct EpochLog {
  double epoch = 0;
  double training_loss = 0;  // mean -log P(outcome | variables) of the training rows [nat]
  double held_out_loss = 0;  // of the held-out rows; not-a-number when there were none
};

struct Model {
  VisibleLayout layout;
  RbmWeights weights;
  std::vector<double> sampled_lower, sampled_upper;  // [variable count]: box in which trials were made
  std::vector<double> training_points;               // [point count x variable count], not-a-number where unknown
  std::vector<std::int32_t> training_outcomes;       // [point count]
  std::vector<double> training_weights;              // [point count], mean 1: prior / proposal density
  InputPrior input_prior;  // of unknown variables; empty: the machine's own joint distribution
  std::vector<EpochLog> log;
  double calibration_power = 1;      // probabilities are raised to it and normalised again (score/calibration.h)
  Json provenance = Json::object();  // data_hash, contract_hash, sampler, seed, settings, counts, scores
};

/// Throws DeviceError when the file cannot be written; never leaves half a file.
void write_model(const std::filesystem::path& path, const Model& model);
/// Throws InputError for files that are missing, truncated, of another schema, with sizes that do not fit one another
/// or with weights that are not finite.
Model read_model(const std::filesystem::path& path);

}  // namespace gonogo::learning
