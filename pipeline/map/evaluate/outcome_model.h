// What a map needs from a trained model. read_map_request() makes one from a model file; tests make their own.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "base/units.h"
#include "pipeline/campaign/study/task_variables.h"
#include "pipeline/map/evaluate/measure_fit.h"
#include "pipeline/map/evaluate/top_speed.h"

namespace gonogo::map {

/// Min cone indices of fine-grained soil for a vehicle (vehicle/semi_empirical/mobility_index.h).
struct ConeIndexNeed {
  std::string vehicle;
  double one_pass = 0, fifty_passes = 0;  // VCI1, VCI50: for one and for fifty passes [Pa]
};

struct OutcomeModel {
  /// Box of the trials that answer for a point [variable count].
  const std::vector<Range>& box_of(std::span<const double> point) const {
    return !crossing_sampled.empty() && campaign::has_task_values(point) ? crossing_sampled : sampled;
  }

  /// Probabilities of the outcomes of contract() for many points at once. NaN marks an unknown variable.
  /// points: [point count x variable count], row by row. result: [point count x outcome count]. Each row of the result
  /// sums to 1 and depends on its own point only.
  std::function<void(std::span<const double> points, std::span<double> result)> probabilities;
  /// The same for bootstrap members of the model (pipeline/learn/training/train_members.h). Their answers widen the
  /// interval on P(go). Empty: the uncertainty of the model is left out of the interval.
  std::vector<std::function<void(std::span<const double> points, std::span<double> result)>> members;
  /// Box in which trials were simulated [variable count]. A variable that was held fixed has equal ends.
  std::vector<Range> sampled;
  /// The same for points with a ditch (crossing_model.h); empty: no trial answers for them.
  std::vector<Range> crossing_sampled;
  /// Distance of a point from the trials, as Predictor::novelty(). Empty: the map gets no novelty layer.
  std::function<double(std::span<const double> point)> novelty;
  std::vector<MeasureFit> measures;  // fitted to trials that passed; empty without a dataset
  std::optional<SpeedModel> speed;   // none: no top speed is given
  std::vector<std::string> remarks;  // one sentence each, for readers of the map
  std::vector<std::string> member_hashes;
  std::string dataset_hash;                 // of the file that `measures` come from; empty without one
  std::string hash;                         // of the model's file
  std::string crossing_hash;                // of the file of the model for ditches; empty without one
  std::string vehicle;                      // name for titles, may be empty
  double gravity = kGravity;                // of the trials [m/s^2]
  bool whole_vehicle = false;               // measures are of all wheels, not of one
  std::optional<ConeIndexNeed> cone_index;  // of the vehicle; none: fine-grained soil is unknown
};

}  // namespace gonogo::map
