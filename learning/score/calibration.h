// Calibration of forecasts: confidence intervals of scores, decomposition of the Brier score, and a correction fitted
// on held-out rows.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/json/json.h"
#include "learning/score/score.h"

namespace gonogo::learning {

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

/// P(y) -> P(y)^power / sum (temperature scaling; Guo et al., ICML 2017).
void sharpen(std::span<double> probability, double power);

/// Power in [0.05, 20] with the smallest mean -w log P(what happened). probability: [row x outcome].
double fit_power(std::span<const double> probability, std::span<const std::size_t> outcome,
                 std::span<const double> weight);

}  // namespace gonogo::learning
