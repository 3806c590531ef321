// A trained model and its file model.h5: weights, biases, the layout as JSON, training points and log, provenance.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/hdf5/hdf5.h"
#include "base/json/json.h"
#include "learning/encoding/layout.h"
#include "learning/model/posterior.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

struct EpochLog {
  double epoch = 0;
  double training_loss = 0;  // mean -log P(outcome | variables) of the training rows [nat]
  double held_out_loss = 0;  // of the held-out rows; NaN without any
};

struct Model {
  VisibleLayout layout;
  RbmWeights weights;
  std::vector<double> sampled_lower, sampled_upper;  // [variable count]: box in which trials were made
  std::vector<double> training_points;               // [point count x variable count], NaN: unknown
  std::vector<std::int32_t> training_outcomes;       // [point count]
  std::vector<double> training_weights;              // [point count], mean 1: prior / proposal density
  InputPrior input_prior;                            // of unknown variables; empty: the machine's joint distribution
  std::vector<EpochLog> log;
  double calibration_power = 1;      // exponent of probabilities before normalisation (score/score.h)
  Json provenance = Json::object();  // data_hash, contract_hash, sampler, seed, settings, counts, scores
};

/// The file is whole or absent. `more` adds groups of its own, such as the teacher of a family's model. Throws
/// DeviceError when it cannot be written.
void write_model(const std::filesystem::path& path, const Model& model,
                 const std::function<void(Hdf5Writer&)>& more = {});
/// An array of a model's file. Throws InputError where it is missing, has another shape, or holds a value that is not a
/// finite number.
std::vector<double> finite_array(const Hdf5Reader& in, const std::string& path,
                                 const std::optional<Shape>& shape = std::nullopt);
/// Throws InputError for files that are missing, truncated, of another schema, inconsistent in their sizes, or with
/// weights that are not finite.
Model read_model(const std::filesystem::path& path);

}  // namespace gonogo::learning
