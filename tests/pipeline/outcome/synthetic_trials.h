// Trials without a simulation: outcomes drawn from a known P(go) that is logistic in slope and friction angle.
#pragma once
#include <cmath>
#include <vector>

#include "base/math/random.h"
#include "pipeline/campaign/setup/record.h"

namespace gonogo::outcome {
using namespace campaign;

/// True P(go or slow_go) of the synthetic trials.
inline double synthetic_p_go(double slope_along, double friction_angle) {
  return 1 / (1 + std::exp(0.3 * (slope_along - 15) - 0.15 * (friction_angle - 33)));
}

/// slope 0..35, friction angle 20..45, cohesion 0..20, relative density 0..1, payload 0..3000, tyre friction 0.4..0.9
/// vary; the others are fixed. About one trial in thirty fails. Every tenth point has a replicate.
inline std::vector<TrialRecord> synthetic_trials(std::size_t count, std::uint64_t seed) {
  std::vector<double> lower = {0, -10, 20, 0, 0, 0, 0.4, 0.3, 2}, upper = {35, 10, 45, 20, 1, 3000, 0.9, 0.3, 2};
  lower.resize(contract().variables.size(), 0);
  upper.resize(contract().variables.size(), 0);
  std::vector<TrialRecord> records;
  for (std::size_t n = 0; n < count; ++n) {
    TrialRecord record;
    const bool replicate = n % 10 == 9;
    const std::size_t drawn = replicate ? n - 1 : n;
    for (std::size_t v = 0; v < contract().variables.size(); ++v)
      record.point.variables.push_back(lower[v] + (upper[v] - lower[v]) * random_unit(seed, drawn, v));
    record.point.index = n;
    record.point.seed = n;
    record.point.replicate_of = replicate ? std::int64_t(drawn) : -1;
    record.measures.assign(contract().measures.size(), 1.0);
    const auto& x = record.point.variables;
    const double u = random_unit(seed, n, 100);
    record.reason = Reason::none;
    if (random_unit(seed, n, 101) < 1.0 / 30) {
      record.verdict = Verdict::unknown;
      record.reason = Reason::simulation_failed;
      record.failed_checks = check_residual;
    } else if (u < synthetic_p_go(x[0], x[2])) {
      record.verdict = u < 0.2 ? Verdict::slow_go : Verdict::go;
    } else {
      record.verdict = Verdict::no_go;
      record.reason = x[0] > 25 ? Reason::slid_back : Reason::traction;
    }
    records.push_back(record);
  }
  return records;
}

}  // namespace gonogo::outcome
