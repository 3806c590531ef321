#include "learning/score/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/math/quad.h"
#include "base/math/random.h"

namespace gonogo::learning {
namespace {

double mean_over(std::span<const double> p, std::span<const int> happened, double (*term)(double, int)) {
  GONOGO_ASSERT(p.size() == happened.size());
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += term(p[i], happened[i]);
  return sum / double(std::max<std::size_t>(p.size(), 1));
}

void wilson_interval(ReliabilityBin& bin) {
  constexpr double z = 1.959963984540054;  // 97.5 % point of the normal distribution
  const double n = double(bin.count), centre = bin.frequency + z * z / (2 * n);
  const double half = z * std::sqrt(bin.frequency * (1 - bin.frequency) / n + z * z / (4 * n * n));
  bin.low = std::max(0.0, (centre - half) / (1 + z * z / n));  // 0 but for rounding when nothing happened
  bin.high = (centre + half) / (1 + z * z / n);
}

}  // namespace

double brier_score(std::span<const double> p, std::span<const int> happened) {
  return mean_over(p, happened, [](double x, int y) { return (x - y) * (x - y); });
}

double log_loss(std::span<const double> p, std::span<const int> happened) {
  return mean_over(p, happened, [](double x, int y) { return -std::log(y ? x : 1 - x); });
}

double accuracy(std::span<const double> p, std::span<const int> happened) {
  return mean_over(p, happened, [](double x, int y) { return double((x >= 0.5) == (y != 0)); });
}

std::vector<ReliabilityBin> reliability(std::span<const double> p, std::span<const int> happened, std::size_t bins) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<ReliabilityBin> result;
  for (std::size_t b = 0; b < bins; ++b) {
    const std::size_t first = order.size() * b / bins, last = order.size() * (b + 1) / bins;
    if (first == last) continue;
    ReliabilityBin bin;
    bin.count = last - first;
    for (std::size_t k = first; k < last; ++k) {
      bin.mean_forecast += p[order[k]] / double(bin.count);
      bin.frequency += happened[order[k]] / double(bin.count);
    }
    wilson_interval(bin);
    result.push_back(bin);
  }
  return result;
}

double calibration_error(const std::vector<ReliabilityBin>& bins) {
  double sum = 0, count = 0;
  for (const ReliabilityBin& bin : bins) {
    sum += double(bin.count) * std::abs(bin.mean_forecast - bin.frequency);
    count += double(bin.count);
  }
  return count > 0 ? sum / count : 0;
}

ScoreFloor score_floor(std::span<const double> p, std::size_t bins, std::uint64_t seed, std::size_t draws) {
  std::vector<double> brier, calibration;
  std::vector<int> happened(p.size());
  for (std::size_t draw = 0; draw < draws; ++draw) {
    for (std::size_t i = 0; i < p.size(); ++i) happened[i] = random_unit(seed, draw, i) < p[i];
    brier.push_back(brier_score(p, happened));
    calibration.push_back(calibration_error(reliability(p, happened, bins)));
  }
  const auto summary = [](std::vector<double>& values, double& mean, double& high) {
    mean = std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
    std::sort(values.begin(), values.end());
    high = values[values.size() * 95 / 100];
  };
  ScoreFloor floor;
  summary(brier, floor.brier_mean, floor.brier_high);
  summary(calibration, floor.calibration_mean, floor.calibration_high);
  return floor;
}

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
  const double highest = *std::max_element(probability.begin(), probability.end());
  for (double& p : probability) p = power * std::log(p / highest);
  take_exponentials(probability);
  const double sum = std::accumulate(probability.begin(), probability.end(), 0.0);
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

ForecastScores forecast_scores(std::span<const double> p, std::span<const int> happened, std::size_t bins,
                               std::uint64_t seed) {
  ForecastScores scores{.trials = p.size(),
                        .brier = bootstrap_mean(brier_terms(p, happened), seed),
                        .log_loss = bootstrap_mean(log_loss_terms(p, happened), seed),
                        .accuracy = accuracy(p, happened),
                        .parts = brier_parts(p, happened, bins),
                        .line = calibration_line(p, happened),
                        .floor = score_floor(p, bins, seed),
                        .reliability = reliability(p, happened, bins)};
  scores.brier.value = brier_score(p, happened);
  scores.log_loss.value = log_loss(p, happened);
  scores.calibration_error = calibration_error(scores.reliability);
  if (!std::isfinite(scores.line.slope_error)) scores.line = {NAN, NAN, NAN, NAN};
  return scores;
}

}  // namespace gonogo::learning
