// A study whose boundary is known: a vehicle climbs while tan(slope) is below a grip that friction and cohesion give.
#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/units.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/setup/record.h"

namespace gonogo::outcome {
using namespace campaign;

/// Slope, friction angle and cohesion vary; all others are held at the middle of what the contract allows.
inline DesignSpec known_boundary_box(std::uint64_t seed, std::uint64_t points) {
  DesignSpec spec{.method = "sobol", .seed = seed, .points = points, .replicate_every = 0, .ranges = {}, .fixed = {}};
  for (const Variable& variable : contract().variables) spec.fixed.push_back((variable.minimum + variable.maximum) / 2);
  const std::vector<std::pair<const char*, std::pair<double, double>>> ranges{
      {"slope_along", {0, 35}}, {"friction_angle", {18, 40}}, {"cohesion", {0, 10}}};
  for (const auto& [name, range] : ranges) {
    const std::size_t i = contract().variable_index(name);
    spec.fixed[i] = std::nan("");
    spec.ranges.push_back({i, range.first, range.second});
  }
  return spec;
}

/// 1 where it climbs, 0 elsewhere.
inline double known_boundary_passes(const DesignSpec& spec, std::span<const double> variables) {
  const double slope = variables[spec.ranges[0].variable], angle = variables[spec.ranges[1].variable];
  const double cohesion = variables[spec.ranges[2].variable];
  return std::tan(slope * kDegree) < 0.6 * std::tan(angle * kDegree) + 0.02 * cohesion ? 1 : 0;
}

/// What a simulation of the point would record: go where it climbs, slid back elsewhere.
inline TrialRecord known_boundary_trial(const DesignSpec& spec, DesignPoint point, std::size_t index) {
  point.index = point.seed = index;
  TrialRecord record;
  record.point = std::move(point);
  record.measures.assign(contract().measures.size(), 1.0);
  const bool passes = known_boundary_passes(spec, record.point.variables) > 0;
  record.verdict = passes ? Verdict::go : Verdict::no_go;
  record.reason = passes ? Reason::none : Reason::slid_back;
  return record;
}

/// Mean squared error of p_go(variables) over 1,000 points that no design holds.
template <class Forecast>
double known_boundary_brier(const DesignSpec& spec, const Forecast& p_go) {
  const std::vector<DesignPoint> held_out = make_design(known_boundary_box(991, 1000));
  double sum = 0;
  for (const DesignPoint& point : held_out) {
    const double error = p_go(point.variables) - known_boundary_passes(spec, point.variables);
    sum += error * error;
  }
  return sum / double(held_out.size());
}

}  // namespace gonogo::outcome
