#include "learning/score/calibration.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"

namespace gonogo::learning {
namespace {

/// Forecasts of exactly 0 and 1 have no logit.
double logit(double p) {
  constexpr double edge = 1e-12;
  const double q = std::clamp(p, edge, 1 - edge);
  return std::log(q / (1 - q));
}

/// Derivative by x of the mean of -w log(P^x / sum P^x).
double power_slope(std::span<const double> probability, std::span<const std::size_t> outcome,
                   std::span<const double> weight, double power) {
  const std::size_t width = probability.size() / outcome.size();
  double slope = 0;
  std::vector<double> p(width);
  for (std::size_t n = 0; n < outcome.size(); ++n) {
    const auto row = probability.subspan(n * width, width);
    std::copy(row.begin(), row.end(), p.begin());
    sharpen(p, power);
    double mean = 0;
    for (std::size_t y = 0; y < width; ++y)
      if (row[y] > 0) mean += p[y] * std::log(row[y]);
    slope += weight[n] * (mean - std::log(std::max(row[outcome[n]], 1e-300)));
  }
  return slope;
}

}  // namespace

Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed, std::size_t draws) {
  GONOGO_ASSERT(!values.empty() && draws >= 40);
  const double count = double(values.size());
  Interval result;
  for (double x : values) result.value += x / count;
  std::vector<double> means(draws, 0.0);
  for (std::size_t d = 0; d < draws; ++d)
    for (std::size_t k = 0; k < values.size(); ++k)
      means[d] += values[std::size_t(random_unit(seed, d, k) * count)] / count;
  std::sort(means.begin(), means.end());
  result.low = means[draws * 25 / 1000];
  result.high = means[draws - 1 - draws * 25 / 1000];
  return result;
}

std::vector<double> brier_terms(std::span<const double> p, std::span<const int> happened) {
  std::vector<double> terms;
  for (std::size_t i = 0; i < p.size(); ++i) terms.push_back((p[i] - happened[i]) * (p[i] - happened[i]));
  return terms;
}

std::vector<double> log_loss_terms(std::span<const double> p, std::span<const int> happened) {
  std::vector<double> terms;
  for (std::size_t i = 0; i < p.size(); ++i) terms.push_back(-std::log(happened[i] ? p[i] : 1 - p[i]));
  return terms;
}

BrierParts brier_parts(std::span<const double> p, std::span<const int> happened, std::size_t bins) {
  const double count = double(p.size());
  double rate = 0;
  for (int y : happened) rate += y / count;
  BrierParts parts;
  parts.uncertainty = rate * (1 - rate);
  for (const ReliabilityBin& bin : reliability(p, happened, bins)) {
    const double share = double(bin.count) / count;
    parts.reliability += share * (bin.mean_forecast - bin.frequency) * (bin.mean_forecast - bin.frequency);
    parts.resolution += share * (bin.frequency - rate) * (bin.frequency - rate);
  }
  parts.within_bins = brier_score(p, happened) - (parts.reliability - parts.resolution + parts.uncertainty);
  return parts;
}

CalibrationLine calibration_line(std::span<const double> p, std::span<const int> happened) {
  GONOGO_ASSERT(p.size() == happened.size());
  CalibrationLine line;
  double a = 0, b = 0, c = 0;  // curvature [[a, b], [b, c]] for (offset, slope)
  for (int iteration = 0; iteration < 100; ++iteration) {
    double g0 = 0, g1 = 0;
    a = b = c = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double x = logit(p[i]), q = 1 / (1 + std::exp(-(line.offset + line.slope * x))), w = q * (1 - q);
      g0 += q - happened[i];
      g1 += (q - happened[i]) * x;
      a += w;
      b += w * x;
      c += w * x * x;
    }
    const double det = a * c - b * b;
    if (!(det > 1e-12 * std::max(a * c, 1e-12))) {  // all forecasts alike: the slope cannot be told
      line.offset_error = line.slope_error = INFINITY;
      return line;
    }
    const double step0 = std::clamp((c * g0 - b * g1) / det, -2.0, 2.0);
    const double step1 = std::clamp((a * g1 - b * g0) / det, -0.5, 0.5);
    line.offset -= step0;
    line.slope -= step1;
    if (std::abs(step0) + std::abs(step1) < 1e-12) break;
  }
  const double det = a * c - b * b;
  line.offset_error = std::sqrt(c / det);
  line.slope_error = std::sqrt(a / det);
  return line;
}

void sharpen(std::span<double> probability, double power) {
  double highest = 0, sum = 0;
  for (double p : probability) highest = std::max(highest, p);
  for (double& p : probability) sum += p = std::pow(p / highest, power);
  for (double& p : probability) p /= sum;
}

double fit_power(std::span<const double> probability, std::span<const std::size_t> outcome,
                 std::span<const double> weight) {
  GONOGO_ASSERT(!outcome.empty() && weight.size() == outcome.size());
  double low = std::log(0.05), high = std::log(20.0);  // the loss is convex in the power: bisect its derivative
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (power_slope(probability, outcome, weight, std::exp(middle)) < 0 ? low : high) = middle;
  }
  return std::exp((low + high) / 2);
}

}  // namespace gonogo::learning
