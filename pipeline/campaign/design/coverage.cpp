#include "pipeline/campaign/design/coverage.h"

#include <algorithm>
#include <cmath>

#include "pipeline/campaign/design/sobol.h"

namespace gonogo::campaign {
namespace {

constexpr std::size_t kMaxCompared = 8192;  // points of a coverage, which compares all pairs
constexpr std::uint32_t kProbes = 4096;
constexpr std::size_t kClimbers = 8;
constexpr double kMinStep = 1e-4;  // [sides of the cube]

using Points = std::vector<std::vector<double>>;

/// [points][sampled variables] in the unit cube of the sampled box.
Points unit_points(const DesignSpec& spec, const std::vector<DesignPoint>& design) {
  Points points;
  for (const DesignPoint& point : design) {
    if (point.replicate_of >= 0) continue;
    if (points.size() == kMaxCompared) break;
    std::vector<double>& unit = points.emplace_back();
    for (const SampledVariable& range : spec.ranges)
      unit.push_back((point.variables[range.variable] - range.minimum) / (range.maximum - range.minimum));
  }
  return points;
}

double largest_gap(const Points& points, std::size_t dimension) {
  std::vector<double> values{0, 1};
  for (const auto& point : points) values.push_back(point[dimension]);
  std::sort(values.begin(), values.end());
  double gap = 0;
  for (std::size_t i = 1; i < values.size(); ++i) gap = std::max(gap, values[i] - values[i - 1]);
  return gap;
}

/// T. T. Warnock, "Computational investigations of low-discrepancy point sets" (1972): the square of the L2 norm.
double squared_discrepancy(const Points& points, std::size_t dimensions) {
  double single = 0, pairs = 0;
  for (const auto& a : points) {
    double product = 1;
    for (const double x : a) product *= (1 - x * x) / 2;
    single += product;
    for (const auto& b : points) {
      double pair = 1;
      for (std::size_t j = 0; j < dimensions; ++j) pair *= 1 - std::max(a[j], b[j]);
      pairs += pair;
    }
  }
  const double n = double(points.size());
  return std::pow(3.0, -double(dimensions)) - 2 * single / n + pairs / (n * n);
}

/// Squared distance to the nearest point, and which it is.
std::pair<double, const std::vector<double>*> nearest(const Points& points, const std::vector<double>& at) {
  std::pair<double, const std::vector<double>*> best{HUGE_VAL, nullptr};
  for (const auto& point : points) {
    double sum = 0;
    for (std::size_t j = 0; j < at.size() && sum < best.first; ++j) sum += (at[j] - point[j]) * (at[j] - point[j]);
    if (sum < best.first) best = {sum, &point};
  }
  return best;
}

/// Steps away from the nearest point while that helps, inside the cube.
double climb(const Points& points, std::vector<double> at) {
  auto [squared, closest] = nearest(points, at);
  for (double step = 0.1; step > kMinStep;) {
    std::vector<double> next = at;
    const double length = std::max(std::sqrt(squared), 1e-12);
    for (std::size_t j = 0; j < at.size(); ++j)
      next[j] = std::clamp(at[j] + step * (at[j] - (*closest)[j]) / length, 0.0, 1.0);
    const auto found = nearest(points, next);
    if (found.first > squared) {
      at = std::move(next);
      squared = found.first;
      closest = found.second;
    } else {
      step /= 2;
    }
  }
  return std::sqrt(squared);
}

}  // namespace

double largest_empty_ball(const Points& points, std::size_t dimensions) {
  if (points.empty()) return std::sqrt(double(dimensions));
  std::vector<std::pair<double, std::vector<double>>> probes;
  for (std::uint32_t i = 0; i < kProbes; ++i) {
    std::vector<double> at(dimensions);
    for (std::size_t j = 0; j < dimensions; ++j) at[j] = scrambled_sobol(i, 0, int(j));
    const double squared = nearest(points, at).first;
    probes.emplace_back(squared, std::move(at));
  }
  std::partial_sort(probes.begin(), probes.begin() + kClimbers, probes.end(),
                    [](const auto& a, const auto& b) { return a.first > b.first; });
  double radius = 0;
  for (std::size_t i = 0; i < kClimbers; ++i) radius = std::max(radius, climb(points, probes[i].second));
  return radius;
}

Coverage coverage(const DesignSpec& spec, const std::vector<DesignPoint>& design) {
  const Points points = unit_points(spec, design);
  const std::size_t dimensions = spec.ranges.size();
  Coverage result;
  result.discrepancy = std::sqrt(std::max(0.0, squared_discrepancy(points, dimensions)));
  // For independent uniform points the mean of the square is (2^-d - 3^-d) / n.
  result.expected_random =
      std::sqrt((std::pow(2.0, -double(dimensions)) - std::pow(3.0, -double(dimensions))) / double(points.size()));
  for (std::size_t j = 0; j < dimensions; ++j)
    result.largest_gap = std::max(result.largest_gap, largest_gap(points, j));
  result.empty_ball = largest_empty_ball(points, dimensions);
  return result;
}

}  // namespace gonogo::campaign
