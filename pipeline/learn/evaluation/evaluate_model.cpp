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

}  // namespace

Json evaluate_model(const std::filesystem::path& model_file, const std::filesystem::path& dataset,
                    const std::filesystem::path& rows) {
  const auto given = rows.empty() ? std::nullopt : std::optional(read_given_rows(rows));
  const Predictor predictor = Predictor::read(model_file);
  const learning::TrainingTable trained = training_table(predictor.model());
  const TrainingData data = make_training_data(campaign::read_dataset(dataset).records, {});
  const std::vector<int> passable = passable_outcomes();
  const std::vector<int> label = passable_labels(trained);
  std::set<std::vector<double>> seen;
  for (std::size_t n = 0; n < trained.row_count(); ++n) seen.insert(comparable(trained.row(n)));

  Forecasts forecasts;
  std::vector<std::size_t> unseen;
  std::size_t trained_on = 0;
  double outcome_loss = 0;
  for (std::size_t n = 0; n < data.table.row_count(); ++n) {
    const auto row = data.table.row(n);
    if (seen.count(comparable(row))) {
      ++trained_on;
      continue;
    }
    const std::vector<double> p = predictor.outcome_probabilities(row);
    forecasts.model.push_back(std::min(1.0, predictor.p_go(row)));
    unseen.push_back(n);
    forecasts.happened.push_back(passable[data.table.outcome[n]]);
    outcome_loss -= std::log(p[data.table.outcome[n]]);
  }
  if (forecasts.happened.empty())
    throw InputError(dataset.string() +
                     ": all its valid trials were trained on; give trials that the model has not seen");
  const Baselines baselines = fit_baselines(trained, label);
  const learning::TrainingTable scored = data.table.subset(unseen);
  forecasts.baselines = baselines.forecasts(scored.variables);
  Json json;
  json["trials"] = Json(std::uint64_t(forecasts.happened.size()));
  json["left_out_unknown"] = Json(std::uint64_t(data.failed));
  json["left_out_trained_on"] = Json(std::uint64_t(trained_on));
  json["outcome_log_loss_nat"] = outcome_loss / double(forecasts.happened.size());
  json["scores"] = score_forecasts(forecasts, 1);
  json["missing"] =
      missing_curve({{"model", [&](std::span<const double> x) { return predictor.p_go(x, kQuickMarginal); }},
                     {"logistic_regression", [&](std::span<const double> x) { return baselines.logistic(x); }},
                     {"quadratic_logistic", [&](std::span<const double> x) { return baselines.quadratic(x); }},
                     {"neural_network", [&](std::span<const double> x) { return baselines.network(x); }},
                     {"base_rate", [&](std::span<const double>) { return baselines.base_rate; }}},
                    scored, forecasts.happened, varying(predictor.model()));
  json["reconstruction"] = reconstruction_scores(predictor, scored);
  json["joint"] = joint_scores(predictor, trained, scored, 1, given);
  json["checks"] = evaluation_checks(json);
  return json;
}

}  // namespace gonogo::learn
