// Scores of P(go) by the model and by its baselines.
#pragma once
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "learning/rbm/regression/baselines.h"
#include "learning/rbm/regression/gaussian_process.h"
#include "learning/score/score.h"
#include "learning/training.h"

namespace gonogo::outcome {

/// Names of the baselines in reports and files, in their order.
inline constexpr const char* kBaselines[] = {"logistic_regression", "quadratic_logistic", "gaussian_process",
                                             "neural_network", "base_rate"};

/// Forecasts of P(go) for the same trials by the model and the baselines.
struct Forecasts {
  std::vector<double> model;                             // [trial]
  std::map<std::string, std::vector<double>> baselines;  // by a name of kBaselines: [trial]
  std::vector<int> happened;                             // [trial] 1: passable, 0: not
};

struct Scores {
  /// The model first, then the baselines in the order of kBaselines.
  std::vector<std::pair<std::string, learning::ForecastScores>> of;

  /// The model minus the baseline that is best by that score; no name where there is no baseline.
  struct Difference {
    std::string baseline;
    learning::Interval value;
  };
  Difference brier, log_loss;

  const learning::ForecastScores& model() const { return of.front().second; }
  /// Name of the forecaster with the least value of a score, the model included.
  std::string best_by(learning::Interval learning::ForecastScores::*score) const;
};

Scores score_forecasts(const Forecasts& forecasts, std::uint64_t seed);

/// Mean of terms - others [trial] with its 95 % interval, by bootstrap over trials. Both are on the same trials, so the
/// interval is narrower than those of the two means.
learning::Interval mean_difference(std::span<const double> terms, std::span<const double> others, std::uint64_t seed);

/// { "value", "low", "high" }
Json interval_json(const learning::Interval& interval);
/// { "model": {...}, a baseline: {...}, ..., "model_minus_best": { "brier", "log_loss_nat" } }
Json to_json(const Scores& scores);
/// Scores that a model file keeps as to_json() wrote them.
Scores read_scores(const Json& json);

/// Scores of all, which of them is best, and the reliability of the model, as text for people.
std::string scores_text(const Scores& scores);

/// All baselines, fitted to the same trials.
struct Baselines {
  learning::LogisticModel logistic;
  learning::QuadraticModel quadratic;
  learning::GaussianProcessModel process;
  learning::NetworkModel network;
  double base_rate = 0.5;

  /// P(1) of many points by every baseline, by its name in kBaselines. points: [point count x variable count].
  std::map<std::string, std::vector<double>> forecasts(std::span<const double> points) const;
};

/// label: [row_count()] of {0, 1}.
Baselines fit_baselines(const learning::TrainingTable& table, std::span<const int> label);

/// P(1) of every row by baselines fitted without the row's fold. The Gaussian process is not among them: it costs most
/// and may be at hand as a teacher (teacher.h). beside: run once, first and on one thread, as if it were a baseline.
std::map<std::string, std::vector<double>> cross_validate_baselines(const learning::TrainingTable& table,
                                                                    std::span<const int> label,
                                                                    const std::vector<std::size_t>& fold,
                                                                    std::size_t fold_count,
                                                                    const std::function<void()>& beside = {});

}  // namespace gonogo::outcome
