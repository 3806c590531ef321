#include "pipeline/learn/evaluation/evaluate_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/answer/predictor.h"
#include "pipeline/learn/evaluation/evaluation_checks.h"
#include "pipeline/learn/evaluation/given_rows.h"
#include "pipeline/learn/evaluation/joint_scores.h"
#include "pipeline/learn/evaluation/missing_curve.h"
#include "pipeline/learn/evaluation/reconstruction.h"
#include "pipeline/learn/training/baselines.h"
#include "pipeline/learn/training/score_report.h"
#include "pipeline/learn/training/training_data.h"

namespace gonogo::learn {
namespace {

std::vector<double> comparable(std::span<const double> point) {
  std::vector<double> key(point.begin(), point.end());
  for (double& x : key)
    if (std::isnan(x)) x = INFINITY;
  return key;
}

/// What the model was trained on. Trials at one point, which are replicates, are one group.
learning::TrainingTable training_table(const learning::Model& model) {
  learning::TrainingTable table;
  table.variable_count = model.layout.variable_count();
  table.variables = model.training_points;
  for (std::int32_t y : model.training_outcomes) table.outcome.push_back(std::size_t(y));
  table.weight = model.training_weights;
  std::map<std::vector<double>, std::uint64_t> group;
  for (std::size_t n = 0; n < table.outcome.size(); ++n)
    table.group.push_back(group.try_emplace(comparable(table.row(n)), n).first->second);
  return table;
}

/// Settings for about 100,000 answers with many unknown variables: short sums, few draws and Markov chains.
constexpr learning::MarginalOptions kQuickMarginal = {
    .max_terms = 2000, .chains = 20, .sweeps = 100, .burn_in = 20, .rungs = 1};

/// Variables that trials had at more than one value.
std::vector<std::size_t> varying(const learning::Model& model) {
  std::vector<std::size_t> result;
  for (std::size_t v = 0; v < model.layout.variable_count(); ++v)
    if (model.layout.encoders()[v].unit_count() > 0) result.push_back(v);
  return result;
}

/// The valid trials of a dataset that a model was not trained on, and what it forecasts for them.
struct Unseen {
  learning::TrainingTable trials;
  Forecasts forecasts;  // without baselines
  Json counts;          // "trials", "left_out_unknown", "left_out_trained_on", "outcome_log_loss_nat"
};

Unseen unseen_trials(const Predictor& predictor, const learning::TrainingTable& trained,
                     const std::filesystem::path& dataset) {
  const TrainingData data = make_training_data(campaign::read_dataset(dataset).records, {});
  const std::vector<int> passable = passable_outcomes();
  std::set<std::vector<double>> seen;
  for (std::size_t n = 0; n < trained.row_count(); ++n) seen.insert(comparable(trained.row(n)));
  Unseen unseen;
  std::vector<std::size_t> rows;
  double outcome_loss = 0;
  for (std::size_t n = 0; n < data.table.row_count(); ++n) {
    const auto row = data.table.row(n);
    if (seen.count(comparable(row))) continue;
    const std::vector<double> p = predictor.outcome_probabilities(row);
    unseen.forecasts.model.push_back(std::min(1.0, predictor.p_go(row)));
    rows.push_back(n);
    unseen.forecasts.happened.push_back(passable[data.table.outcome[n]]);
    outcome_loss -= std::log(p[data.table.outcome[n]]);
  }
  if (rows.empty())
    throw InputError(dataset.string() +
                     ": all its valid trials were trained on; give trials that the model has not seen");
  unseen.trials = data.table.subset(rows);
  unseen.counts["trials"] = Json(std::uint64_t(rows.size()));
  unseen.counts["left_out_unknown"] = Json(std::uint64_t(data.failed));
  unseen.counts["left_out_trained_on"] = Json(std::uint64_t(data.table.row_count() - rows.size()));
  unseen.counts["outcome_log_loss_nat"] = outcome_loss / double(rows.size());
  return unseen;
}

/// A model beside the trials that it is scored on, and rows of its joint distribution where they are given.
struct Evaluation {
  Evaluation(const std::filesystem::path& model_file, const std::filesystem::path& dataset,
             const std::filesystem::path& rows)
      : given(rows.empty() ? std::nullopt : std::optional(read_given_rows(rows))),
        predictor(Predictor::read(model_file)),
        trained(training_table(predictor.model())),
        unseen(unseen_trials(predictor, trained, dataset)) {}

  Json joint() const { return joint_scores(predictor, trained, unseen.trials, 1, given); }

  std::optional<learning::TrainingTable> given;
  Predictor predictor;
  learning::TrainingTable trained;
  Unseen unseen;
};

}  // namespace

Json evaluate_model(const std::filesystem::path& model_file, const std::filesystem::path& dataset,
                    const std::filesystem::path& rows) {
  Evaluation evaluation(model_file, dataset, rows);
  Unseen& unseen = evaluation.unseen;
  const Predictor& predictor = evaluation.predictor;
  const Baselines baselines = fit_baselines(evaluation.trained, passable_labels(evaluation.trained));
  unseen.forecasts.baselines = baselines.forecasts(unseen.trials.variables);
  Json json = std::move(unseen.counts);
  json["scores"] = score_forecasts(unseen.forecasts, 1);
  json["missing"] =
      missing_curve({{"model", [&](std::span<const double> x) { return predictor.p_go(x, kQuickMarginal); }},
                     {"logistic_regression", [&](std::span<const double> x) { return baselines.logistic(x); }},
                     {"quadratic_logistic", [&](std::span<const double> x) { return baselines.quadratic(x); }},
                     {"neural_network", [&](std::span<const double> x) { return baselines.network(x); }},
                     {"base_rate", [&](std::span<const double>) { return baselines.base_rate; }}},
                    unseen.trials, unseen.forecasts.happened, varying(predictor.model()));
  json["reconstruction"] = reconstruction_scores(predictor, unseen.trials);
  json["joint"] = evaluation.joint();
  json["checks"] = evaluation_checks(json);
  return json;
}

Json evaluate_joint(const std::filesystem::path& model_file, const std::filesystem::path& dataset,
                    const std::filesystem::path& rows) {
  Evaluation evaluation(model_file, dataset, rows);
  Unseen& unseen = evaluation.unseen;
  Json json = std::move(unseen.counts);
  json["scores"] = score_forecasts(unseen.forecasts, 1);
  json["joint"] = evaluation.joint();
  return json;
}

}  // namespace gonogo::learn
