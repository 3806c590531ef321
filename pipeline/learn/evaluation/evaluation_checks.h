// What a model has to hold against its baselines, read off an evaluation.
#pragma once
#include <string>

#include "base/json/json.h"

namespace gonogo::learn {

/// Calibration error that a model may have above that of a perfectly calibrated forecaster with its forecasts.
inline constexpr double kMaxCalibrationError = 0.02;
/// Inputs that are hidden when the model is compared with mean imputation.
inline constexpr std::int64_t kHiddenInputs = 2;

/// Of a report of evaluate_model: { "what", "holds", "value", "limit", "low", "high" } for
///   Brier score and log loss    minus those of the baseline that is best by them, at most 0 within the interval
///   calibration error           minus its floor, at most kMaxCalibrationError
///   two inputs hidden           Brier score minus that of each baseline with mean imputation, below 0; "low" and
///   "high"
///                               say how surely. Left out where fewer inputs vary.
/// low and high are null where there is no interval.
Json evaluation_checks(const Json& report);
std::string checks_text(const Json& checks);

}  // namespace gonogo::learn
