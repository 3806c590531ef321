// What goes into a trial and what comes out: the row of the dataset.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/study/contract.h"

namespace gonogo::pipeline {

/// One point of a design. Its trial is a pure function of (study, point): same point, same bits.
struct DesignPoint {
  std::uint64_t index = 0;         // position in the design, 0-based
  std::uint64_t seed = 0;          // of the bed; replicates differ only here
  std::int64_t replicate_of = -1;  // index of the point whose variables this one repeats, or -1
  double proposal_density = 1;     // of the design at this point, relative to uniform over the sampled box
  std::vector<double> variables;   // [contract().variables.size()], in the units of the contract
};

/// What one wheel did over the last half of the driving.
struct WheelRecord {
  std::string name;    // "front left"
  double slip = 0;     // 1 - travelled / rolled distance [-]
  double sinkage = 0;  // [m]
  double torque = 0;   // driving [N m]
};

/// Means over a part of a drawbar sweep.
struct PullPoint {
  double pull = 0;     // load at the hitch over the vehicle's weight [-]
  double slip = 0;     // [-]
  double speed = 0;    // [m/s]
  double sinkage = 0;  // [m]
  double torque = 0;   // per driven wheel [N m]
};

struct TrialRecord {
  DesignPoint point;
  Verdict verdict = Verdict::unknown;
  Reason reason = Reason::simulation_failed;
  std::vector<double> measures;     // [contract().measures.size()]; NaN where a failed trial has none
  std::vector<WheelRecord> wheels;  // of a whole vehicle whose drive was judged; not part of the dataset
  std::vector<PullPoint> pull;      // of a drawbar sweep, in the order of time; not part of the dataset
  std::uint64_t attempts = 1;       // 2 when the first attempt failed a check and the smaller step was used
};

}  // namespace gonogo::pipeline
