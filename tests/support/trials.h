// Trials whose outcome follows from a closed form, for tests of what happens around them.
#pragma once
#include <cmath>
#include <limits>

#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/campaign/setup/record.h"

namespace gonogo::campaign {

/// Climbs while tan(slope) stays below friction; every measure of a climb is a hash of the point, some are special
/// values.
inline TrialRecord closed_form_trial(const DesignPoint& point) {
  const double slope = std::tan(point.variables[contract().variable_index("slope_along")] * kDegree);
  const double grip = std::tan(point.variables[contract().variable_index("friction_angle")] * kDegree) *
                      (0.9 + 0.2 * random_unit(point.seed, 1, 0));
  TrialRecord record;
  record.point = point;
  record.verdict = slope < 0.6 * grip ? Verdict::go : slope < 0.8 * grip ? Verdict::slow_go : Verdict::no_go;
  record.reason =
      record.verdict == Verdict::no_go ? (point.seed % 2 ? Reason::traction : Reason::sinkage) : Reason::none;
  for (std::size_t i = 0; i < contract().measures.size(); ++i)
    record.measures.push_back(contract().measures[i].task.empty()
                                  ? (random_unit(point.seed, 2, i) - 0.5) * std::pow(10.0, double(i) * 3 - 12)
                                  : kNaN);
  record.measures[1] = -0.0;
  if (record.verdict == Verdict::no_go) record.measures[2] = -std::numeric_limits<double>::quiet_NaN();
  if (point.seed % 13 == 5) {
    record.verdict = Verdict::unknown;
    record.reason = Reason::simulation_failed;
    record.attempts = 2;
    record.failed_checks = point.seed % 31 + 1;
  }
  return record;
}

}  // namespace gonogo::campaign
