// What a map needs of a trained model. pipeline/map/model_source.h makes one from a model file; tests make their own.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/map/evaluate/measure_fit.h"

namespace gonogo::map {

/// Cone indices that a vehicle needs in fine-grained soil (vehicle/semi_empirical/mobility_index.h).
struct ConeIndexNeed {
  std::string vehicle;
  double one_pass = 0, fifty_passes = 0;  // VCI1, VCI50 [Pa]
};

struct OutcomeModel {
  /// Probabilities of the outcomes of contract() for many points at once; a not-a-number marks an unknown variable.
  /// points: [point count x variable count] row by row, result: [point count x outcome count]. Each row sums to 1 and
  /// does not depend on the others.
  std::function<void(std::span<const double> points, std::span<double> result)> probabilities;
  /// The same of models that might as well have come of the trials (pipeline/learn/training/train_members.h); their
  /// answers widen the interval on P(go). Empty: the spread of the model is not known.
  std::vector<std::function<void(std::span<const double> points, std::span<double> result)>> members;
  /// Box in which trials were simulated, [variable count]; a variable held fixed has equal ends.
  std::vector<Range> sampled;
  /// How far a point is from the trials (Predictor::novelty); empty when the model does not tell.
  std::function<double(std::span<const double> point)> novelty;
  std::vector<MeasureFit> measures;  // of trials that passed; empty when no dataset was given
  std::vector<std::string> member_hashes;
  std::string dataset_hash;                 // of the file that they come from
  std::string hash;                         // of the model's file
  std::string vehicle;                      // name for titles, may be empty
  std::optional<ConeIndexNeed> cone_index;  // of the vehicle; nothing: not known, fine-grained soil is then unknown
};

}  // namespace gonogo::map
