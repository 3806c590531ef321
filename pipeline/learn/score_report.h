// Scores of P(go) beside the baselines, as one report.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::pipeline {

/// Forecasts for the same trials by the model and the baselines, and what happened (1: passable).
struct Forecasts {
  std::vector<double> model, logistic, network, base_rate;  // [trial]
  std::vector<int> happened;                                // [trial]
};

/// { "model": {...}, "logistic_regression": {...}, "neural_network": {...}, "base_rate": {...} }, each as
/// learning::score_report makes it, and "model_minus_best": the baseline with the least Brier score, and the difference
/// to it in Brier score and log loss with 95 % intervals (bootstrap over trials, which all forecasters share).
Json score_forecasts(const Forecasts& forecasts, std::uint64_t seed);

/// Those of the four that the scores hold.
std::vector<std::string> forecaster_names(const Json& scores);

/// The table of scores and the reliability of the model for people.
std::string scores_text(const Json& scores);

}  // namespace gonogo::pipeline
