#include "learning/score/score.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/random.h"
#include "learning/score/calibration.h"

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

Json score_report(std::span<const double> p, std::span<const int> happened, std::size_t bins, std::uint64_t seed) {
  const auto curve = reliability(p, happened, bins);
  const ScoreFloor floor = score_floor(p, bins, seed);
  Json json, rows = Json::array();
  json["trials"] = Json(std::int64_t(p.size()));
  json["brier"] = brier_score(p, happened);
  json["log_loss_nat"] = log_loss(p, happened);
  json["accuracy"] = accuracy(p, happened);
  json["calibration_error"] = calibration_error(curve);
  const Interval brier = bootstrap_mean(brier_terms(p, happened), seed);
  const Interval loss = bootstrap_mean(log_loss_terms(p, happened), seed);
  json["brier_low"] = brier.low;
  json["brier_high"] = brier.high;
  json["log_loss_low"] = loss.low;
  json["log_loss_high"] = loss.high;
  const BrierParts parts = brier_parts(p, happened, bins);
  json["brier_reliability"] = parts.reliability;
  json["brier_resolution"] = parts.resolution;
  json["brier_uncertainty"] = parts.uncertainty;
  json["brier_within_bins"] = parts.within_bins;
  const CalibrationLine line = calibration_line(p, happened);
  const bool told = std::isfinite(line.slope_error);  // not where all forecasts are alike
  json["calibration_slope"] = told ? Json(line.slope) : Json();
  json["calibration_slope_error"] = told ? Json(line.slope_error) : Json();
  json["calibration_offset"] = told ? Json(line.offset) : Json();
  json["calibration_offset_error"] = told ? Json(line.offset_error) : Json();
  json["floor_brier_mean"] = floor.brier_mean;
  json["floor_brier_95"] = floor.brier_high;
  json["floor_calibration_error_mean"] = floor.calibration_mean;
  json["floor_calibration_error_95"] = floor.calibration_high;
  for (const ReliabilityBin& bin : curve) {
    Json row;
    row["count"] = Json(std::int64_t(bin.count));
    row["mean_forecast"] = bin.mean_forecast;
    row["frequency"] = bin.frequency;
    row["frequency_low"] = bin.low;
    row["frequency_high"] = bin.high;
    rows.push_back(std::move(row));
  }
  json["reliability"] = std::move(rows);
  return json;
}

}  // namespace gonogo::learning
