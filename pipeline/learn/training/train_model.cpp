#include "pipeline/learn/training/train_model.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "base/version.h"
#include "learning/model/model.h"
#include "learning/rbm/logistic.h"
#include "learning/rbm/train.h"
#include "learning/score/calibration.h"
#include "pipeline/campaign/dataset/trial_inputs.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/learn/training/baselines.h"
#include "pipeline/learn/training/kept_work.h"
#include "pipeline/learn/training/score_report.h"
#include "pipeline/learn/training/teacher.h"
#include "pipeline/learn/training/training_progress.h"
#include "pipeline/learn/training/training_sampler.h"

namespace gonogo::learn {
namespace {

/// Too few groups of trials for the folds asked for: as many folds as groups.
std::size_t usable_folds(const learning::TrainingTable& table, std::size_t asked) {
  std::vector<std::uint64_t> groups(table.group);
  std::sort(groups.begin(), groups.end());
  const auto distinct = std::size_t(std::unique(groups.begin(), groups.end()) - groups.begin());
  return std::min(asked, distinct);
}

/// Scores of P(go) on rows that each forecaster did not train on.
Json cross_validation_scores(const TrainingData& data, const learning::CrossValidation& folds, std::size_t fold_count,
                             std::uint64_t seed, Teacher& teacher) {
  const std::vector<int> passable = passable_outcomes();
  const auto& table = data.table;
  const std::vector<std::size_t> fold = learning::assign_folds(table, fold_count, seed);
  Forecasts forecasts;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    double p = 0;
    for (std::size_t y = 0; y < passable.size(); ++y) p += passable[y] * folds.probability[n * passable.size() + y];
    forecasts.model.push_back(p);
    forecasts.happened.push_back(passable[table.outcome[n]]);
  }
  forecasts.baselines = cross_validate_baselines(table, forecasts.happened, fold, fold_count);
  forecasts.baselines["gaussian_process"] = teacher.held_out();
  return score_forecasts(forecasts, seed);
}

/// The power that calibrates held-out rows best. Leaves out the rows of fold `without`.
double fitted_power(const TrainingData& data, const std::vector<double>& probability,
                    const std::vector<std::size_t>& fold, std::size_t without) {
  const std::size_t outcomes = probability.size() / fold.size();
  std::vector<double> rows, weight;
  std::vector<std::size_t> outcome;
  for (std::size_t n = 0; n < fold.size(); ++n) {
    if (fold[n] == without) continue;
    rows.insert(rows.end(), probability.begin() + std::ptrdiff_t(n * outcomes),
                probability.begin() + std::ptrdiff_t((n + 1) * outcomes));
    outcome.push_back(data.table.outcome[n]);
    weight.push_back(data.table.weight[n]);
  }
  return learning::fit_power(rows, outcome, weight);
}

/// Sharpens every fold's forecasts by the power that the other folds choose, and returns the power that all choose.
double calibrate(const TrainingData& data, learning::CrossValidation& folds, std::size_t fold_count,
                 std::uint64_t seed) {
  const std::vector<std::size_t> fold = learning::assign_folds(data.table, fold_count, seed);
  const std::vector<double> before = folds.probability;
  const std::size_t outcomes = before.size() / fold.size();
  std::vector<double> power;
  for (std::size_t f = 0; f < fold_count; ++f) power.push_back(fitted_power(data, before, fold, f));
  for (std::size_t n = 0; n < fold.size(); ++n)
    learning::sharpen(std::span(folds.probability).subspan(n * outcomes, outcomes), power[fold[n]]);
  return fitted_power(data, before, fold, fold_count);
}

/// The rate of failed simulations among all trials, held-out ones included, modelled apart from the outcomes: overall
/// with its interval, and by a logistic regression on the variables, whose largest value over the trials is reported.
Json failure_report(const TrainingData& data, const learning::TrainingTable& held_out) {
  learning::TrainingTable all = data.table;
  for (const std::vector<double>* rows : {&held_out.variables, &data.failed_variables})
    all.variables.insert(all.variables.end(), rows->begin(), rows->end());
  std::vector<int> failed(data.trials - data.failed, 0);
  failed.resize(data.trials, 1);
  all.outcome.resize(data.trials, 0);
  all.weight.assign(data.trials, 1.0);
  all.group.resize(data.trials, 0);
  const std::vector<double> certain(data.trials, double(data.failed) / double(data.trials));
  const auto overall = learning::reliability(certain, failed, 1);
  Json json;
  json["rate"] = certain.empty() ? 0.0 : certain.front();
  json["rate_low"] = overall.front().low;
  json["rate_high"] = overall.front().high;
  if (data.failed == 0) return json;
  const learning::LogisticModel model = learning::fit_logistic(all, failed);
  double highest = 0;
  Json weights = Json::object();
  for (std::size_t n = 0; n < all.row_count(); ++n) highest = std::max(highest, model(all.row(n)));
  for (std::size_t v = 0; v < all.variable_count; ++v)
    weights[campaign::contract().variables[v].name] = model.weight[v];
  json["modelled_rate_highest"] = highest;
  json["weights_per_standard_deviation"] = std::move(weights);
  return json;
}

Json counts_report(const TrainingData& data) {
  Json json, outcomes = Json::object();
  json["trials"] = Json(std::uint64_t(data.trials));
  json["trained_on"] = Json(std::uint64_t(data.table.row_count()));
  json["left_out_unknown"] = Json(std::uint64_t(data.failed));
  for (std::size_t y = 0; y < campaign::contract().outcomes.size(); ++y)
    outcomes[campaign::contract().outcomes[y].name] = Json(std::uint64_t(data.outcome_count[y]));
  json["outcomes"] = std::move(outcomes);
  return json;
}

/// Folds of a stand-in are not kept: the run that continues would not know of it.
learning::FoldStore fold_store(const KeptWork& kept, TrainingProgress& progress, const TrainingSampler& source) {
  learning::FoldStore store;
  store.find = [&](std::size_t fold) {
    std::optional<learning::FoldResult> found = kept.fold(fold);
    if (found) progress.reuse_machine();
    return found;
  };
  store.keep = [&](std::size_t fold, const learning::FoldResult& result) {
    if (!source.stood_in()) kept.keep_fold(fold, result);
  };
  return store;
}

}  // namespace

std::string work_key(const TrainRequest& request, const LearningSettings& settings) {
  Json key;
  key["dataset"] = file_hash(request.dataset);
  key["contract"] = content_hash(campaign::contract_text());
  key["program"] = std::string(program_version()) + " " + program_revision();
  key["settings"] = to_json(settings);
  for (const std::filesystem::path& other : request.others) key["others"].push_back(file_hash(other));
  if (request.design) key["design"] = request.design->json();
  key["hold_out"] = Json(std::uint64_t(request.hold_out));
  for (const std::uint64_t group : request.groups) key["groups"].push_back(Json(group));
  key["seed"] = Json(request.seed);
  return content_hash(key.dump());
}

LearningSettings trainable_settings(const std::optional<Config>& section) {
  const LearningSettings settings = read_learning_settings(section);
  if (settings.training.gradients == learning::GradientDevice::cuda && !learning::gradients_on_gpu())
    section->fail("gradients",
                  "is cuda, but LibTorch sees no GPU here; Debian's libtorch-dev has no CUDA: choose cpu, or build "
                  "against a LibTorch that has (README.md, GONOGO_TORCH)");
  return settings;
}

Json train_model(const TrainRequest& request) {
  LearningSettings settings = trainable_settings(request.learning);
  const campaign::Dataset dataset = campaign::read_dataset(request.dataset);
  const double gravity = campaign::settings_of(dataset.provenance, request.dataset.string()).gravity;
  TrainingData data = make_training_data(dataset.records, request.design);
  temper_weights(data, settings.importance);
  learning::TrainingTable held_out;
  if (request.hold_out > 0) held_out = hold_out(data, request.hold_out, request.seed);
  if (!request.groups.empty()) keep_groups(data, request.groups);
  settings = settings_for_trials(std::move(settings), data.table.row_count());
  learning::Model model;
  model.layout = make_layout(data, settings);
  learning::TrainingSettings training = training_settings(settings, data.table.row_count(), request.seed);
  TrainingSampler source(settings, model.layout, training);
  const std::size_t folds = usable_folds(data.table, settings.folds);
  if (folds < 2) throw InputError(request.dataset.string() + ": trials at two points or more are needed to train");

  const OtherTrials others = read_other_trials(request.dataset, request.others);
  const KeptWork kept(request.model, work_key(request, settings));
  TrainingProgress progress(folds, training.epochs, source.watch());
  const double taught = settings.teacher.value_or(teacher_weight(data.table.row_count()));
  Teacher teacher(data, others, taught, learning::assign_folds(data.table, folds, training.seed), request.seed, kept);
  learning::CrossValidation validation = cross_validate(
      model.layout, data.table, training, source.sampler(), folds,
      [&](std::size_t done) {
        progress.machine_done(done);
        source.begin();
      },
      progress.watch(), fold_store(kept, progress, source),
      [&](std::size_t fold) {
        return progress.teach(data.table.row_count() * (folds - 1) / folds, [&] { return teacher.of_fold(fold); });
      });
  training.epochs = validation.best_epoch;
  progress.last_machine(training.epochs);
  if (settings.calibrate) model.calibration_power = calibrate(data, validation, folds, training.seed);
  const auto lesson = progress.teach(data.table.row_count(), [&] { return teacher.of_all(); });
  model.weights =
      train_rbm(model.layout, data.table, training, source.sampler(), progress.watch(), nullptr, lesson.get()).weights;
  model.log = validation.log;
  model.sampled_lower = data.lower;
  model.sampled_upper = data.upper;
  model.training_points = data.table.variables;
  model.training_weights = data.table.weight;
  if (settings.uniform_inputs) model.input_prior = learning::uniform_prior(model.layout);
  model.training_outcomes.assign(data.table.outcome.begin(), data.table.outcome.end());

  Json& report = model.provenance;
  report["data_hash"] = file_hash(request.dataset);
  report["contract_hash"] = content_hash(campaign::contract_text());
  report["program_version"] = program_version();
  if (gravity != kGravity) report[campaign::kGravityKey] = gravity;
  source.report(report);
  report["calibration_power"] = model.calibration_power;
  report["seed"] = Json(request.seed);
  report["settings"] = to_json(settings);
  report["teacher_weight"] = taught;
  if (!others.empty()) report["other_trials"] = others.report;
  report["batch"] = Json(std::uint64_t(training.batch));
  report["epochs"] = Json(std::uint64_t(validation.best_epoch));
  report["counts"] = counts_report(data);
  report["counts"]["held_out"] = Json(std::uint64_t(held_out.row_count()));
  report["failures"] = failure_report(data, held_out);
  report["cross_validation"] = cross_validation_scores(data, validation, folds, training.seed, teacher);
  report["cross_validation"]["folds"] = Json(std::uint64_t(folds));
  learning::write_model(request.model, model);
  if (!request.members_follow) kept.remove();
  return report;
}

}  // namespace gonogo::learn
