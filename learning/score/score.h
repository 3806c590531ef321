// Scores of probability forecasts p against what happened (0 or 1), their calibration, and a correction fitted on
// held-out rows.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

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

struct Interval {
  double value = 0, low = 0, high = 0;  // 95 %
};

/// Mean of values with its percentile bootstrap interval over `draws` resamples (Efron & Tibshirani 1993,
/// section 13.3).
Interval bootstrap_mean(std::span<const double> values, std::uint64_t seed, std::size_t draws = 1000);

std::vector<double> brier_terms(std::span<const double> p, std::span<const int> happened);     // (p - happened)^2
std::vector<double> log_loss_terms(std::span<const double> p, std::span<const int> happened);  // [nat]

/// Brier = reliability - resolution + uncertainty + within_bins (Murphy 1973). within_bins comes from the spread of
/// forecasts in a bin (Stephenson, Coelho, Jolliffe 2008, equation 10).
struct BrierParts {
  double reliability = 0, resolution = 0, uncertainty = 0, within_bins = 0;
};
BrierParts brier_parts(std::span<const double> p, std::span<const int> happened, std::size_t bins);

/// logit P(happened) = offset + slope logit p by maximum likelihood (Cox 1958). Calibrated forecasts have offset 0 and
/// slope 1; overconfident ones a slope below 1. Errors are standard errors, infinite when forecasts separate the
/// outcomes.
struct CalibrationLine {
  double offset = 0, slope = 1, offset_error = 0, slope_error = 0;
};
CalibrationLine calibration_line(std::span<const double> p, std::span<const int> happened);

/// All scores above of forecasts of the same trials.
struct ForecastScores {
  std::size_t trials = 0;
  Interval brier, log_loss;  // log loss [nat]
  double accuracy = 0, calibration_error = 0;
  BrierParts parts;
  CalibrationLine line;  // NaN where its errors are infinite, as where all forecasts are alike
  ScoreFloor floor;
  std::vector<ReliabilityBin> reliability;
};
ForecastScores forecast_scores(std::span<const double> p, std::span<const int> happened, std::size_t bins,
                               std::uint64_t seed);

/// P(y) -> P(y)^power / sum (temperature scaling; Guo et al., ICML 2017).
void sharpen(std::span<double> probability, double power);

/// Power in [0.05, 20] with the smallest mean -w log P(what happened). probability: [row x outcome].
double fit_power(std::span<const double> probability, std::span<const std::size_t> outcome,
                 std::span<const double> weight);

}  // namespace gonogo::learning
