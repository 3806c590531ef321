// Pass criteria for a model against its baselines.
#pragma once
#include <string>

#include "base/json/json.h"

namespace gonogo::learn {

/// Max calibration error above the floor. The floor is the error that a perfectly calibrated forecaster with the same
/// forecasts would show.
inline constexpr double kMaxCalibrationError = 0.02;
/// Number of inputs that are hidden to compare the model with mean imputation.
inline constexpr std::int64_t kHiddenInputs = 2;

/// Max distance of the coverage of intervals of 90 % from 0.9.
inline constexpr double kMaxCoverageMiss = 0.03;

/// Checks a report of evaluate_model(). One entry { "what", "holds", "value", "limit", "low", "high" } for each of
///
///   Brier score, log loss   difference to the best baseline by that score; holds if the interval reaches 0 or below
///   calibration error       above its floor; holds up to kMaxCalibrationError
///   two inputs hidden       Brier score minus that of each baseline with mean imputation; holds below 0
///   reconstruction        coverage within kMaxCoverageMiss of 0.9; log loss below that of the prior of the inputs
///
/// "low" and "high" bound the 95 % interval, or are null without one. The last two are left out if too few inputs
/// vary, or the report has no reconstruction.
Json evaluation_checks(const Json& report);
std::string checks_text(const Json& checks);

}  // namespace gonogo::learn
