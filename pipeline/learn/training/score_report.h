// Scores of P(go) beside the baselines, as one report.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::learn {

/// Forecasts for the same trials by the model and the baselines, and what happened (1: passable).
struct Forecasts {
  std::vector<double> model, logistic, network, base_rate;  // [trial]
  std::vector<int> happened;                                // [trial]
};

/// { "model": {...}, "logistic_regression": {...}, "neural_network": {...}, "base_rate": {...} }, each as
/// learning::score_report makes it, and "model_minus_best": { "brier", "log_loss_nat" }, each the difference to the
/// baseline that is best by that score, with its name.
Json score_forecasts(const Forecasts& forecasts, std::uint64_t seed);

/// { "value", "low", "high" }: mean of terms - others on the same trials with its 95 % interval (bootstrap over
/// trials), which is narrower than those of the two means.
Json difference_json(std::span<const double> terms, std::span<const double> others, std::uint64_t seed);

/// Those of the four that the scores hold.
std::vector<std::string> forecaster_names(const Json& scores);

/// The table of scores and the reliability of the model for people.
std::string scores_text(const Json& scores);

}  // namespace gonogo::learn
