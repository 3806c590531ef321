// Scores of P(go) by the model and by its baselines.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::learn {

/// Forecasts of P(go) for the same trials by the model and the baselines.
struct Forecasts {
  std::vector<double> model, logistic, network, base_rate;  // [trial]
  std::vector<int> happened;                                // [trial] 1: passable, 0: not
};

/// { "model", "logistic_regression", "neural_network", "base_rate" }, each as learning::score_report() makes it, and
/// "model_minus_best": { "brier", "log_loss_nat" }. These are differences to the baseline that is best by that score,
/// with its name.
Json score_forecasts(const Forecasts& forecasts, std::uint64_t seed);

/// { "value", "low", "high" }: mean of terms - others [trial] with its 95 % interval, by bootstrap over trials. Both
/// are on the same trials, so the interval is narrower than those of the two means.
Json difference_json(std::span<const double> terms, std::span<const double> others, std::uint64_t seed);

/// Names of the forecasters that `scores` holds, in the order above.
std::vector<std::string> forecaster_names(const Json& scores);

/// Scores and reliability of the model as text for people.
std::string scores_text(const Json& scores);

}  // namespace gonogo::learn
