#include "pipeline/outcome/answer/novelty.h"

#include <algorithm>
#include <cmath>

namespace gonogo::outcome {

Novelty::Novelty(const learning::Model& model) : trials_(model.training_outcomes.size()) {
  const std::size_t variables = model.layout.variable_count();
  for (std::size_t v = 0; v < variables; ++v) {
    const double width = model.sampled_upper[v] - model.sampled_lower[v];
    if (!(width > 0)) continue;
    Axis axis{v, width, std::vector<double>(trials_)};
    for (std::size_t n = 0; n < trials_; ++n) axis.trial[n] = model.training_points[n * variables + v];
    axis_.push_back(std::move(axis));
  }
  typical_ = median_of_neighbours(model);
}

double Novelty::of(std::span<const double> point) const { return nearest(point, kNone) / typical_; }

/// Axis by axis over all trials, so that the loops run on vectors.
double Novelty::nearest(std::span<const double> point, std::size_t skip) const {
  std::vector<double> sum(trials_, 0.0), known(trials_, 0.0);
  for (const Axis& axis : axis_) {
    const double at = point[axis.variable], width = axis.width;
    if (std::isnan(at)) continue;
    for (std::size_t n = 0; n < trials_; ++n) {
      const double d = (at - axis.trial[n]) / width;
      sum[n] += d == d ? d * d : 0;
      known[n] += d == d ? 1 : 0;
    }
  }
  if (skip < trials_) sum[skip] = INFINITY;
  double least = INFINITY;
  for (std::size_t n = 0; n < trials_; ++n) least = std::min(least, sum[n] / std::max(known[n], 1.0));
  return std::sqrt(least);
}

double Novelty::median_of_neighbours(const learning::Model& model) const {
  const std::size_t variables = model.layout.variable_count();
  std::vector<double> distances;
  for (std::size_t n = 0; n < trials_; ++n) {
    const double distance = nearest(std::span(model.training_points).subspan(n * variables, variables), n);
    if (distance > 0 && std::isfinite(distance)) distances.push_back(distance);
  }
  if (distances.empty()) return 1;
  std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(distances.size() / 2), distances.end());
  return distances[distances.size() / 2];
}

}  // namespace gonogo::outcome
