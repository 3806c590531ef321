// Input and result of a trial: the row of the dataset.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/campaign/study/contract.h"

namespace gonogo::campaign {

/// Value of a measure that a trial does not have.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// One point of a design. Its trial is a pure function of (study, point): same point, same bits.
struct DesignPoint {
  std::uint64_t index = 0;         // position in the design, 0-based
  std::uint64_t seed = 0;          // of the bed; replicates differ only here
  std::int64_t replicate_of = -1;  // index of the point whose variables this one repeats, or -1
  double proposal_density = 1;     // of the design at this point, relative to uniform over the sampled box
  std::vector<double> variables;   // [contract().variables.size()], in the units of the contract
};

/// Bits of failed checks in datasets. The first three have the values of sim::StepFlag.
enum CheckBit : std::uint64_t {
  check_not_finite = 1,
  check_too_fast = 2,
  check_left_domain = 4,
  check_residual = 8,
  check_energy = 16
};

/// A check that a simulation must pass before its outcome counts.
struct Check {
  const char* name;
  CheckBit bit;
  const char* about;
};
inline constexpr std::array<Check, 5> kChecks{
    {{"not_finite", check_not_finite, "a velocity or place became no number"},
     {"too_fast", check_too_fast, "a body crossed more than a bin in a step"},
     {"left_domain", check_left_domain, "a body fell out of the domain"},
     {"residual", check_residual, "contact residual above the study's limit"},
     {"energy", check_energy, "energy that nothing supplied above the study's limit"}}};

/// "residual+energy": the checks whose bits are set, or "none".
inline std::string names_of_checks(std::uint64_t bits) {
  std::string names;
  for (const Check& check : kChecks)
    if (bits & check.bit) names += (names.empty() ? "" : "+") + std::string(check.name);
  return names.empty() ? "none" : names;
}

/// What one wheel did over the last half of the driving.
struct WheelRecord {
  std::string name;    // "front left", of tracks also "left sprocket"
  double slip = 0;     // 1 - travelled / rolled distance [-]; NaN for what is not driven
  double sinkage = 0;  // [m]; NaN for what touches no ground
  double torque = 0;   // driving [N m]
};

/// Means over a part of a drawbar sweep, or over the last half of the way of a wheel whose slip is imposed.
struct PullPoint {
  double pull = 0;     // load at the hitch over the vehicle's weight [-]; of such a wheel along its heading
  double slip = 0;     // [-]
  double speed = 0;    // [m/s]
  double sinkage = 0;  // [m]
  double torque = 0;   // per driven wheel [N m]
  double side = 0;     // force of the soil to the wheel's left over the weight, of a wheel at a slip angle [-]
};

struct TrialRecord {
  DesignPoint point;
  Verdict verdict = Verdict::unknown;
  Reason reason = Reason::simulation_failed;
  std::vector<double> measures;     // [contract().measures.size()]; NaN where a failed trial has none
  std::vector<WheelRecord> wheels;  // of a whole vehicle whose drive was judged; not part of the dataset
  std::vector<PullPoint> pull;      // of a drawbar sweep, in the order of time; not part of the dataset
  std::uint64_t attempts = 1;       // 2 when the first attempt failed a check and the smaller step was used
  std::uint64_t failed_checks = 0;  // bits of the checks that the last attempt of an unknown trial failed
};

/// Whether trials of every type have this measure, or this one has it.
inline bool has_measure(const TrialRecord& r, std::size_t measure) {
  return contract().measures[measure].task.empty() || !std::isnan(r.measures[measure]);
}

/// A variable or a measure by its name in the contract.
inline double variable_of(const TrialRecord& r, const char* name) {
  return r.point.variables[contract().variable_index(name)];
}
inline double measure_of(const TrialRecord& r, const char* name) { return r.measures[contract().measure_index(name)]; }

}  // namespace gonogo::campaign
