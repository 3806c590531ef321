#include "pipeline/outcome/evaluation/evaluate_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/training_data.h"
#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::outcome {
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

/// A model beside the trials that it is scored on: the valid ones of a dataset that it was not trained on.
struct Comparison {
  learning::TrainingTable trained, unseen;
  Forecasts forecasts;    // of the unseen trials, without baselines
  Evaluation evaluation;  // counts, outcome log loss and joint scores
};

Comparison compare(const Predictor& predictor, const campaign::Dataset& dataset, const std::string& where,
                   const std::filesystem::path& rows_file) {
  const std::optional<learning::TrainingTable> given =
      rows_file.empty() ? std::nullopt : std::optional(read_given_rows(rows_file));
  Comparison result{.trained = training_table(predictor.model()), .unseen = {}, .forecasts = {}, .evaluation = {}};
  const TrainingData data = make_training_data(dataset.records, {});
  const std::vector<int> passable = passable_outcomes();
  std::set<std::vector<double>> seen;
  for (std::size_t n = 0; n < result.trained.row_count(); ++n) seen.insert(comparable(result.trained.row(n)));
  std::vector<std::size_t> rows;
  double outcome_loss = 0;
  for (std::size_t n = 0; n < data.table.row_count(); ++n) {
    const auto row = data.table.row(n);
    if (seen.count(comparable(row))) continue;
    const std::vector<double> p = predictor.outcome_probabilities(row);
    result.forecasts.model.push_back(std::min(1.0, predictor.p_go(row)));
    rows.push_back(n);
    result.forecasts.happened.push_back(passable[data.table.outcome[n]]);
    outcome_loss -= std::log(p[data.table.outcome[n]]);
  }
  if (rows.empty())
    throw InputError(where + ": all its valid trials were trained on; give trials that the model has not seen");
  result.unseen = data.table.subset(rows);
  result.evaluation.trials = rows.size();
  result.evaluation.unknown = data.failed;
  result.evaluation.trained_on = data.table.row_count() - rows.size();
  result.evaluation.outcome_log_loss = outcome_loss / double(rows.size());
  result.evaluation.joint = joint_scores(predictor, result.trained, result.unseen, 1, given);
  return result;
}

}  // namespace

Evaluation evaluate_model(const std::filesystem::path& model, const std::filesystem::path& dataset,
                          const std::filesystem::path& rows) {
  return evaluate_model(Predictor::read(model), campaign::read_dataset(dataset), dataset.string(), rows);
}

Evaluation evaluate_model(const Predictor& predictor, const campaign::Dataset& trials, const std::string& where,
                          const std::filesystem::path& rows) {
  Comparison compared = compare(predictor, trials, where, rows);
  const Baselines baselines = fit_baselines(compared.trained, passable_labels(compared.trained));
  compared.forecasts.baselines = baselines.forecasts(compared.unseen.variables);
  Evaluation evaluation = std::move(compared.evaluation);
  evaluation.scores = score_forecasts(compared.forecasts, 1);
  evaluation.missing =
      missing_curve({{"model", [&](std::span<const double> x) { return predictor.p_go(x, kQuickMarginal); }},
                     {"logistic_regression", [&](std::span<const double> x) { return baselines.logistic(x); }},
                     {"quadratic_logistic", [&](std::span<const double> x) { return baselines.quadratic(x); }},
                     {"neural_network", [&](std::span<const double> x) { return baselines.network(x); }},
                     {"base_rate", [&](std::span<const double>) { return baselines.base_rate; }}},
                    compared.unseen, compared.forecasts.happened, varying_inputs(predictor.model().layout));
  evaluation.reconstruction = reconstruction_scores(predictor, compared.unseen);
  evaluation.checks = evaluation_checks(evaluation);
  return evaluation;
}

Evaluation evaluate_joint(const std::filesystem::path& model_file, const std::filesystem::path& dataset,
                          const std::filesystem::path& rows) {
  Comparison compared = compare(Predictor::read(model_file), campaign::read_dataset(dataset), dataset.string(), rows);
  compared.evaluation.scores = score_forecasts(compared.forecasts, 1);
  return std::move(compared.evaluation);
}

namespace {

std::string reliability_csv(const Scores& scores) {
  std::string text = "forecaster,trials,mean_forecast,frequency,frequency_low,frequency_high\n";
  for (const auto& [who, of] : scores.of)
    for (const learning::ReliabilityBin& bin : of.reliability)
      text += line("%s,%zu,%.17g,%.17g,%.17g,%.17g\n", who.c_str(), bin.count, bin.mean_forecast, bin.frequency,
                   bin.low, bin.high);
  return text;
}

std::string missing_csv(const std::vector<MissingPoint>& curve) {
  std::string text = "hidden,subsets,trials,forecaster,brier,log_loss_nat,model_minus_brier,low,high\n";
  for (const MissingPoint& point : curve)
    for (const MissingPoint::Scored& scored : point.scored) {
      text += line("%zu,%zu,%zu,%s,%.17g,%.17g", point.hidden, point.subsets, point.trials, scored.name.c_str(),
                   scored.brier, scored.log_loss);
      const learning::Interval& d = scored.brier_difference;  // not of the model from itself
      text += &scored == &point.scored.front() ? ",,,\n" : line(",%.17g,%.17g,%.17g\n", d.value, d.low, d.high);
    }
  return text;
}

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

report::Chart reliability_chart(const Scores& scores) {
  report::Chart chart{.title = "Reliability: forecast and what happened",
                      .x_label = "forecast P(go)",
                      .y_label = "share that passed, 95 % interval",
                      .diagonal = true,
                      .series = {}};
  for (const auto& [who, of] : scores.of) {
    report::ChartSeries series{.label = in_words(who), .x = {}, .y = {}, .low = {}, .high = {}};
    for (const learning::ReliabilityBin& bin : of.reliability) {
      series.x.push_back(bin.mean_forecast);
      series.y.push_back(bin.frequency);
      if (who != "model") continue;
      series.low.push_back(bin.low);
      series.high.push_back(bin.high);
    }
    if (who != "base_rate") chart.series.push_back(std::move(series));
  }
  return chart;
}

report::Chart missing_chart(const std::vector<MissingPoint>& curve) {
  report::Chart chart{.title = "Brier score with inputs hidden (lower is better)",
                      .x_label = "inputs hidden",
                      .y_label = "Brier score",
                      .x_high = double(curve.size() - 1),
                      .y_high = 0,
                      .series = {}};
  for (std::size_t k = 0; k < curve.front().scored.size(); ++k) {
    report::ChartSeries series{
        .label = in_words(curve.front().scored[k].name), .x = {}, .y = {}, .low = {}, .high = {}};
    for (const MissingPoint& point : curve) {
      series.x.push_back(double(point.hidden));
      series.y.push_back(point.scored[k].brier);
      chart.y_high = std::max(chart.y_high, 1.35 * series.y.back());
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

std::vector<Criterion> evaluation_checks(const Evaluation& evaluation) {
  std::vector<Criterion> checks;
  const auto against_best = [&](const char* name, const Scores::Difference& best) {
    checks.push_back({std::string(name) + " minus that of " + best.baseline, best.value.low <= 0, best.value.value, 0,
                      best.value.low, best.value.high});
  };
  against_best("Brier score", evaluation.scores.brier);
  against_best("log loss", evaluation.scores.log_loss);
  const learning::ForecastScores& model = evaluation.scores.model();
  const double above = model.calibration_error - model.floor.calibration_mean;
  checks.push_back({"calibration error above its floor", above <= kMaxCalibrationError, above, kMaxCalibrationError});
  for (const MissingPoint& point : evaluation.missing) {
    if (point.hidden != kHiddenInputs) continue;
    for (std::size_t k = 1; k < point.scored.size(); ++k) {
      const auto& [name, brier, loss, difference, other] = point.scored[k];
      if (name != "base_rate")
        checks.push_back({"two inputs hidden: Brier score minus that of " + name + " with mean imputation",
                          difference.value < 0, difference.value, 0, difference.low, difference.high});
    }
  }
  if (const auto& found = evaluation.reconstruction; found && found->left_out.empty()) {
    const double miss = std::abs(found->coverage.value - 0.9);
    checks.push_back({"two inputs reconstructed: coverage of intervals of 90 % away from 0.9", miss <= kMaxCoverageMiss,
                      miss, kMaxCoverageMiss});
    checks.push_back({"two inputs reconstructed: log loss minus that of their prior", found->gain.value > 0,
                      -found->gain.value, 0, -found->gain.high, -found->gain.low});
  }
  return checks;
}

Json to_json(const Evaluation& evaluation) {
  Json json = Json::Object{{"trials", evaluation.trials},
                           {"left_out_unknown", evaluation.unknown},
                           {"left_out_trained_on", evaluation.trained_on},
                           {"outcome_log_loss_nat", evaluation.outcome_log_loss},
                           {"scores", to_json(evaluation.scores)}};
  if (!evaluation.missing.empty()) json["missing"] = to_json(evaluation.missing);
  if (evaluation.reconstruction) json["reconstruction"] = to_json(*evaluation.reconstruction);
  json["joint"] = to_json(evaluation.joint);
  if (evaluation.checks.empty()) return json;
  Json checks = Json::array();
  for (const Criterion& check : evaluation.checks)
    checks.push_back(Json::Object{{"what", check.what},
                                  {"holds", check.holds},
                                  {"value", check.value},
                                  {"limit", check.limit},
                                  {"low", check.low},
                                  {"high", check.high}});
  json["checks"] = std::move(checks);
  return json;
}

std::string checks_text(const std::vector<Criterion>& checks) {
  std::string text = "checks of the model:\n";
  for (const Criterion& check : checks) {
    text += line("  %-6s %-84s %+.4f", check.holds ? "holds" : "misses", check.what.c_str(), check.value);
    if (!std::isnan(check.low)) text += line(" [%+.4f, %+.4f]", check.low, check.high);
    text += line(", at most %.2f\n", check.limit);
  }
  return text;
}

std::string evaluation_text(const Evaluation& evaluation) {
  return line(
             "%zu trials that the model has not seen (%zu failed and %zu trained on are left out); log loss over all "
             "outcomes %.4f nat\n",
             evaluation.trials, evaluation.unknown, evaluation.trained_on, evaluation.outcome_log_loss) +
         scores_text(evaluation.scores) + missing_text(evaluation.missing) +
         reconstruction_text(*evaluation.reconstruction) + joint_text(evaluation.joint) +
         checks_text(evaluation.checks);
}

std::vector<std::filesystem::path> write_evaluation(const std::filesystem::path& folder, const Json& report,
                                                    const Scores& scores, const std::vector<MissingPoint>& missing) {
  std::filesystem::create_directories(folder);
  std::vector<std::filesystem::path> files = {folder / "evaluation.json", folder / "reliability.csv"};
  write_file_atomically(files[0], report.dump(2) + "\n");
  write_file_atomically(files[1], reliability_csv(scores));
  if (!missing.empty()) {
    files.push_back(folder / "missing.csv");
    write_file_atomically(files.back(), missing_csv(missing));
  }
  if (!report::pictures_available()) return files;
  std::vector<report::Chart> charts = {reliability_chart(scores)};
  if (!missing.empty()) charts.push_back(missing_chart(missing));
  files.push_back(folder / "evaluation.png");
  report::write_charts(files.back(), line("P(go) on %zu trials that training did not see", scores.model().trials),
                       charts);
  return files;
}

}  // namespace gonogo::outcome
