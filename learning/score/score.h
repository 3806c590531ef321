// Scores of probability forecasts p against what happened (0 or 1).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/json/json.h"

namespace gonogo::learning {

double brier_score(std::span<const double> p, std::span<const int> happened);  // mean (p - happened)^2
double log_loss(std::span<const double> p, std::span<const int> happened);     // mean -log P(what happened) [nat]
double accuracy(std::span<const double> p, std::span<const int> happened);     // share with (p >= 0.5) == happened

/// A bin of similar forecasts, with the observed frequency and its 95 % interval (Wilson 1927).
struct ReliabilityBin {
  std::size_t count = 0;
  double mean_forecast = 0, frequency = 0, low = 0, high = 0;
};
/// Bins with equally many forecasts.
std::vector<ReliabilityBin> reliability(std::span<const double> p, std::span<const int> happened, std::size_t bins);
/// Expected calibration error: mean over bins of |mean forecast - frequency|, weighted by count.
double calibration_error(const std::vector<ReliabilityBin>& bins);

/// Scores of perfectly calibrated forecasts of these values at this sample size, by simulation. Smaller scores cannot
/// be distinguished from chance.
struct ScoreFloor {
  double brier_mean = 0, brier_high = 0;              // mean and 95 % quantile
  double calibration_mean = 0, calibration_high = 0;  // of the expected calibration error
};
ScoreFloor score_floor(std::span<const double> p, std::size_t bins, std::uint64_t seed, std::size_t draws = 1000);

/// All scores here and in calibration.h as a JSON object.
Json score_report(std::span<const double> p, std::span<const int> happened, std::size_t bins, std::uint64_t seed);

}  // namespace gonogo::learning
