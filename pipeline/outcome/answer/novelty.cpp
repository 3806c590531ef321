#include "pipeline/outcome/answer/novelty.h"

#include <algorithm>
#include <cmath>

namespace gonogo::outcome {

Novelty::Novelty(const learning::Model& model)
    : variables_(model.layout.variable_count()),
      trials_(model.training_outcomes.size()),
      points_(model.training_points) {
  for (std::size_t v = 0; v < variables_; ++v) {
    const double width = model.sampled_upper[v] - model.sampled_lower[v];
    if (!(width > 0)) continue;
    Axis axis{v, width, std::vector<Pack>((trials_ + kPackWidth - 1) / kPackWidth, constant<Pack>(INFINITY))};
    for (std::size_t n = 0; n < trials_; ++n) {
      const double x = trial(n)[v];
      complete_ = complete_ && !std::isnan(x);
      axis.scaled[n / kPackWidth][n % kPackWidth] = Real(x / width);
    }
    axis_.push_back(std::move(axis));
  }
  typical_ = median_of_neighbours();
}

double Novelty::of(std::span<const double> point) const { return nearest(point, kNone) / typical_; }

/// The squared distance to trial n is (x / w)^2 + c_n - 2 x x_n / w^2, so that the nearest trial at x is the least of
/// straight lines in x: their lower envelope is found once.
void Novelty::along(std::span<const double> point, std::size_t variable, std::span<const double> values,
                    std::span<double> result) const {
  std::vector<double> at(point.begin(), point.end());
  const auto axis = std::find_if(axis_.begin(), axis_.end(), [&](const Axis& a) { return a.variable == variable; });
  if (!complete_ || axis == axis_.end() || trials_ == 0) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      at[variable] = values[i];
      result[i] = of(at);
    }
    return;
  }
  struct Line {
    double slope, constant;
    std::size_t trial;
    double operator()(double x) const { return constant + slope * x; }
  };
  std::vector<Line> lines;
  for (std::size_t n = 0; n < trials_; ++n) {
    Line line{-2 * trial(n)[variable] / (axis->width * axis->width), 0, n};
    for (const Axis& a : axis_) {
      const double d =
          (a.variable == variable ? trial(n)[variable] : trial(n)[a.variable] - point[a.variable]) / a.width;
      if (!std::isnan(d)) line.constant += d * d;
    }
    lines.push_back(line);
  }
  std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
    return a.slope != b.slope         ? a.slope > b.slope
           : a.constant != b.constant ? a.constant < b.constant
                                      : a.trial < b.trial;
  });
  std::vector<Line> lowest;  // from small x to large
  for (const Line& line : lines) {
    if (!lowest.empty() && lowest.back().slope == line.slope) continue;
    const auto is_hidden = [&] {
      const Line &a = lowest[lowest.size() - 2], &b = lowest.back();
      return (line.constant - a.constant) * (a.slope - b.slope) <= (b.constant - a.constant) * (a.slope - line.slope);
    };
    while (lowest.size() > 1 && is_hidden()) lowest.pop_back();
    lowest.push_back(line);
  }
  std::size_t k = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    while (k + 1 < lowest.size() && lowest[k + 1](values[i]) < lowest[k](values[i])) ++k;
    at[variable] = values[i];
    result[i] = distance(at, lowest[k].trial) / typical_;
  }
}

double Novelty::nearest(std::span<const double> point, std::size_t skip) const {
  if (complete_ && trials_ > 0) {
    const std::size_t n = nearest_trial(point, skip);
    return n == kNone ? INFINITY : distance(point, n);
  }
  double least = INFINITY;
  for (std::size_t n = 0; n < trials_; ++n)
    if (n != skip) least = std::min(least, distance(point, n));
  return least;
}

/// In single precision, eight trials at a time; kNone if there is no other.
std::size_t Novelty::nearest_trial(std::span<const double> point, std::size_t skip) const {
  std::vector<Pack> square((trials_ + kPackWidth - 1) / kPackWidth);
  for (const Axis& axis : axis_) {
    if (std::isnan(point[axis.variable])) continue;
    const Pack at = constant<Pack>(Real(point[axis.variable] / axis.width));
    for (std::size_t b = 0; b < square.size(); ++b) square[b] += (at - axis.scaled[b]) * (at - axis.scaled[b]);
  }
  Pack least = constant<Pack>(INFINITY);
  if (skip < trials_) square[skip / kPackWidth][skip % kPackWidth] = INFINITY;
  for (const Pack& s : square) least = select(s < least, s, least);
  Real smallest = INFINITY;
  for (int lane = 0; lane < kPackWidth; ++lane) smallest = std::min(smallest, least[lane]);
  for (std::size_t n = 0; n < trials_; ++n)
    if (n != skip && square[n / kPackWidth][n % kPackWidth] == smallest) return n;
  return kNone;
}

/// Root mean square over the variables that both know.
double Novelty::distance(std::span<const double> point, std::size_t n) const {
  double sum = 0, known = 0;
  for (const Axis& axis : axis_) {
    const double d = (point[axis.variable] - trial(n)[axis.variable]) / axis.width;
    if (std::isnan(d)) continue;
    sum += d * d;
    known += 1;
  }
  return known > 0 ? std::sqrt(sum / known) : 0;
}

double Novelty::median_of_neighbours() const {
  std::vector<double> distances;
  for (std::size_t n = 0; n < trials_; ++n) {
    const double distance = nearest(trial(n), n);
    if (distance > 0 && std::isfinite(distance)) distances.push_back(distance);
  }
  if (distances.empty()) return 1;
  std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(distances.size() / 2), distances.end());
  return distances[distances.size() / 2];
}

}  // namespace gonogo::outcome
