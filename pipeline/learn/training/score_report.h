// Scores of P(go) by the model and by its baselines.
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::learn {

/// Names of the baselines in reports and files, in their order.
inline constexpr const char* kBaselines[] = {"logistic_regression", "quadratic_logistic", "gaussian_process",
                                             "neural_network", "base_rate"};

/// Forecasts of P(go) for the same trials by the model and the baselines.
struct Forecasts {
  std::vector<double> model;                             // [trial]
  std::map<std::string, std::vector<double>> baselines;  // by a name of kBaselines: [trial]
  std::vector<int> happened;                             // [trial] 1: passable, 0: not
};

/// { "model", ... }: the model and every baseline, each as learning::score_report() makes it, and
/// "model_minus_best": { "brier", "log_loss_nat" }. These are differences to the baseline that is best by that score,
/// with its name. Without baselines there is none.
Json score_forecasts(const Forecasts& forecasts, std::uint64_t seed);

/// { "value", "low", "high" }: mean of terms - others [trial] with its 95 % interval, by bootstrap over trials. Both
/// are on the same trials, so the interval is narrower than those of the two means.
Json difference_json(std::span<const double> terms, std::span<const double> others, std::uint64_t seed);

/// Names of the forecasters that `scores` holds, in the order above.
std::vector<std::string> forecaster_names(const Json& scores);

/// Name of the forecaster with the least "brier" or "log_loss_nat", the model included.
std::string best_forecaster(const Json& scores, const std::string& score);

/// Scores of all, which of them is best, and the reliability of the model, as text for people.
std::string scores_text(const Json& scores);

}  // namespace gonogo::learn
