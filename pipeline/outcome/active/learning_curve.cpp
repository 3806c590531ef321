#include "pipeline/outcome/active/learning_curve.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/math/statistics.h"
#include "base/progress.h"
#include "learning/score/score.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/scores.h"
#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::outcome {

std::vector<std::uint64_t> grown_groups(const learning::TrainingTable& table, const std::vector<std::uint64_t>& taken,
                                        std::size_t count, const ModelAnswers& model, std::uint64_t seed) {
  constexpr std::uint64_t kGrowStream = 0x67726f77;  // of random numbers
  std::map<std::uint64_t, std::size_t> first_row, size;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    first_row.try_emplace(table.group[n], n);
    ++size[table.group[n]];
  }
  std::vector<std::uint64_t> groups = taken, rest;
  std::size_t rows = 0;
  for (const std::uint64_t group : taken) {
    first_row.erase(group);
    rows += size.at(group);
  }
  std::vector<double> points;
  for (const auto& [group, row] : first_row) {
    rest.push_back(group);
    points.insert(points.end(), table.row(row).begin(), table.row(row).end());
  }
  if (rest.empty()) return groups;
  const std::vector<double> density =
      choice_densities(model, points, table.variable_count, BatchRequest{}.space_filling);
  // Without replacement: those with the least exponential times of rates `density` (Efraimidis & Spirakis, Inf.
  // Process. Lett. 97:181, 2006).
  std::vector<std::pair<double, std::uint64_t>> time;
  for (std::size_t i = 0; i < rest.size(); ++i)
    time.emplace_back(-std::log1p(-random_unit(seed, kGrowStream, rest[i])) / density[i], rest[i]);
  std::sort(time.begin(), time.end());
  for (const auto& [t, group] : time) {
    if (rows >= count) break;
    groups.push_back(group);
    rows += size.at(group);
  }
  std::sort(groups.begin(), groups.end());
  return groups;
}

namespace {

namespace fs = std::filesystem;

struct Point {
  std::size_t trials = 0, subset = 1;
};

/// The trials that are left to train on, and those that score.
struct Split {
  TrainingData training;
  learning::TrainingTable held_out;
};

Split split_of(const TrainRequest& request) {
  const LearningSettings settings = trainable_settings(request.learning);
  Split split{make_training_data(campaign::read_dataset(request.dataset).records, request.design), {}};
  temper_weights(split.training, settings.importance);
  split.held_out = hold_out(split.training, request.hold_out, request.seed);
  return split;
}

std::vector<Point> curve_points(const LearningCurveRequest& request, std::size_t left) {
  if (request.trials.empty()) throw InputError("learning curve: give one number of trials to train on at least");
  if (request.training.hold_out == 0) throw InputError("learning curve: hold trials out to score the models on");
  std::vector<std::size_t> numbers = request.trials;
  if (request.active) std::sort(numbers.begin(), numbers.end());
  std::vector<Point> points;
  for (std::size_t trials : numbers) {
    if (trials < 10 || trials > left)
      throw InputError("learning curve: " + std::to_string(trials) +
                       " trials to train on; give a number between 10 and " + std::to_string(left) +
                       ", which are left after holding out " + std::to_string(request.training.hold_out));
    for (std::size_t k = 1; k <= (trials == left ? 1 : request.subsets); ++k) points.push_back({trials, k});
  }
  return points;
}

std::map<std::string, std::vector<double>> forecasts_of(const TrainRequest& request, const Split& split) {
  TrainingData fewer = split.training;
  keep_groups(fewer, request.groups);
  std::map<std::string, std::vector<double>> forecasts =
      fit_baselines(fewer.table, passable_labels(fewer.table)).forecasts(split.held_out.variables);
  std::vector<double> p(split.held_out.row_count());
  Predictor::read(request.model).p_go(split.held_out.variables, p);
  for (double& x : p) x = std::clamp(x, 1e-12, 1 - 1e-12);
  forecasts["model"] = p;
  return forecasts;
}

fs::path place_of(const LearningCurveRequest& request, const Point& point) {
  return request.folder / line("trials_%zu_subset_%zu", point.trials, point.subset);
}

Json point_json(const CurvePoint& point) {
  Json brier = Json::object(), loss = Json::object();
  for (const auto& [name, score] : point.brier) brier[name] = score;
  for (const auto& [name, score] : point.log_loss) loss[name] = score;
  return Json::Object{{"trials", point.trials},
                      {"subset", point.subset},
                      {"brier", std::move(brier)},
                      {"log_loss_nat", std::move(loss)}};
}

/// Scores that a call with the same key left.
std::optional<CurvePoint> earlier_scores(const fs::path& file, const std::string& key) {
  if (!fs::exists(file)) return std::nullopt;
  const Json found = Json::read(file);
  if (found.at("key").string() != key) return std::nullopt;
  const Json& scores = found.at("scores");
  CurvePoint point{.trials = scores.at("trials").unsigned_integer(),
                   .subset = scores.at("subset").unsigned_integer(),
                   .brier = {},
                   .log_loss = {}};
  for (const auto& [name, score] : scores.at("brier").members()) point.brier[name] = score.number();
  for (const auto& [name, score] : scores.at("log_loss_nat").members()) point.log_loss[name] = score.number();
  return point;
}

/// The next smaller number of trials of the curve; nothing for the smallest.
std::optional<std::size_t> number_before(const LearningCurveRequest& request, std::size_t trials) {
  std::optional<std::size_t> before;
  for (const std::size_t n : request.trials)
    if (n < trials && n > before.value_or(0)) before = n;
  return before;
}

/// Groups that train the model of a point. Those of an active curve follow from the model of the number before, which
/// is trained already, and the first ones from the forecast.
std::vector<std::uint64_t> groups_of(const LearningCurveRequest& request, const Split& split, const Point& point) {
  const learning::TrainingTable& table = split.training.table;
  const std::optional<std::size_t> before = request.active ? number_before(request, point.trials) : std::nullopt;
  if (!before && request.active && request.training.forecast)
    return grown_groups(table, {}, point.trials, answers_of(*request.training.forecast), point.subset);
  if (!before) return drawn_groups(table, point.trials, point.subset);
  const Point smaller{*before, point.subset};
  const Predictor predictor = Predictor::read(place_of(request, smaller) / "model.h5");
  return grown_groups(table, groups_of(request, split, smaller), point.trials, answers_of(predictor), point.subset);
}

/// Whether the models that choose a point's trials are trained.
bool can_begin(const LearningCurveRequest& request, const Point& point, const std::string& key) {
  const std::optional<std::size_t> before = request.active ? number_before(request, point.trials) : std::nullopt;
  return !before || earlier_scores(place_of(request, {*before, point.subset}) / "scores.json", key);
}

/// Scores of the model, which an interrupted call may have trained already.
CurvePoint scored(const LearningCurveRequest& request, const Split& split, const Point& point, const std::string& key) {
  TrainRequest training = request.training;
  training.groups = groups_of(request, split, point);
  training.model = place_of(request, point) / "model.h5";
  const fs::path trained = place_of(request, point) / "trained.txt";
  if (!fs::exists(training.model) || !fs::exists(trained) || read_file(trained) != key) {
    train_model(training);
    write_file_atomically(trained, key);
  }
  const std::vector<int> happened = passable_labels(split.held_out);
  CurvePoint result{.trials = point.trials, .subset = point.subset, .brier = {}, .log_loss = {}};
  for (const auto& [name, p] : forecasts_of(training, split)) {
    result.brier[name] = learning::brier_score(p, happened);
    result.log_loss[name] = learning::log_loss(p, happened);
  }
  return result;
}

/// Scores the model of a point, if nobody has yet and no other process is at it. Returns true if this call did.
bool score(const LearningCurveRequest& request, const Split& split, const Point& point, const std::string& key) {
  const fs::path file = place_of(request, point) / "scores.json";
  if (earlier_scores(file, key) || !can_begin(request, point, key)) return false;
  const auto lock = lock_folder_if_free(file.parent_path());
  if (!lock || earlier_scores(file, key)) return false;
  const Json kept = Json::Object{{"key", key}, {"scores", point_json(scored(request, split, point, key))}};
  write_file_atomically(file, kept.dump(2) + "\n");
  return true;
}

/// An active curve depends on its numbers of trials, too: each follows from the one before.
std::string curve_key(const LearningCurveRequest& request) {
  const std::string key = work_key(request.training, trainable_settings(request.training.learning));
  if (!request.active) return key;
  std::vector<std::size_t> trials = request.trials;
  std::sort(trials.begin(), trials.end());
  std::string text = key + " active";
  for (const std::size_t n : trials) text += " " + std::to_string(n);
  return content_hash(text);
}

}  // namespace

LearningCurve learning_curve(const LearningCurveRequest& request) {
  if (request.training.hold_out == 0) throw InputError("learning curve: hold trials out to score the models on");
  const Split split = split_of(request.training);
  const std::vector<Point> points = curve_points(request, split.training.table.row_count());
  const std::string key = curve_key(request);
  create_folder(request.folder);
  Progress progress("learning curve", "models", points.size());
  std::size_t done = 0, trained = 0;
  for (const Point& point : points) {
    trained += score(request, split, point, key);
    ++done;
    progress.update(done, "", done - trained);
  }
  LearningCurve curve{.key = key, .held_out = split.held_out.row_count(), .points = {}};
  for (const Point& point : points)
    if (std::optional<CurvePoint> scores = earlier_scores(place_of(request, point) / "scores.json", key))
      curve.points.push_back(std::move(*scores));
  curve.elsewhere = points.size() - curve.points.size();
  write_file_atomically(request.folder / "learning_curve.json", to_json(curve).dump(2) + "\n");
  return curve;
}

Json to_json(const LearningCurve& curve) {
  Json points = Json::array();
  for (const CurvePoint& point : curve.points) points.push_back(point_json(point));
  return Json::Object{
      {"key", curve.key}, {"held_out", curve.held_out}, {"points", std::move(points)}, {"elsewhere", curve.elsewhere}};
}

namespace {

/// Scores of each forecaster at one number of trials, one of each subset.
using ByName = std::map<std::string, std::vector<double>>;

using Score = std::map<std::string, double> CurvePoint::*;

std::map<std::size_t, ByName> collected(const LearningCurve& curve, Score score) {
  std::map<std::size_t, ByName> result;
  for (const CurvePoint& point : curve.points)
    for (const auto& [name, value] : point.*score) result[point.trials][name].push_back(value);
  return result;
}

std::vector<std::string> names() {
  std::vector<std::string> result = {"model"};
  result.insert(result.end(), std::begin(kBaselines), std::end(kBaselines));
  return result;
}

std::string best_of(const ByName& scores) {
  return std::min_element(
             scores.begin(), scores.end(),
             [](const auto& a, const auto& b) { return mean_error(a.second).mean < mean_error(b.second).mean; })
      ->first;
}

std::string table_of(const LearningCurve& curve, Score score, const std::string& title) {
  std::string text = title + "\n" + line("%7s %7s", "trials", "subsets");
  for (const std::string& name : names()) text += line(" %20s", name.c_str());
  text += "  best\n";
  for (const auto& [trials, scores] : collected(curve, score)) {
    text += line("%7zu %7zu", trials, scores.begin()->second.size());
    for (const std::string& name : names()) text += line(" %20.4f", mean_error(scores.at(name)).mean);
    text += "  " + best_of(scores) + "\n";
  }
  return text;
}

report::Chart chart_of(const LearningCurve& curve) {
  report::Chart chart{.title = "Brier score on held-out trials (lower is better)",
                      .x_label = "trials trained on",
                      .y_label = "mean over subsets, standard error",
                      .x_low = INFINITY,
                      .x_high = 0,
                      .y_high = 0,
                      .log_x = true,
                      .legend_right = true,
                      .series = {}};
  const auto points = collected(curve, &CurvePoint::brier);
  for (const std::string& name : names()) {
    if (name == "base_rate") continue;
    report::ChartSeries series{.label = name, .x = {}, .y = {}, .low = {}, .high = {}};
    std::replace(series.label.begin(), series.label.end(), '_', ' ');
    for (const auto& [trials, scores] : points) {
      const MeanError s = mean_error(scores.at(name));
      series.x.push_back(double(trials));
      series.y.push_back(s.mean);
      series.low.push_back(s.mean - s.error);
      series.high.push_back(s.mean + s.error);
      chart.x_low = std::min(chart.x_low, series.x.back() / 1.25);
      chart.x_high = std::max(chart.x_high, series.x.back() * 1.25);
      chart.y_high = std::max(chart.y_high, 1.2 * series.high.back());
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

std::string learning_curve_text(const LearningCurve& curve) {
  if (curve.points.empty()) return "no model is ready: other processes train all of them\n";
  const std::string held_out = std::to_string(curve.held_out) + " held-out trials, mean over the subsets";
  return table_of(curve, &CurvePoint::brier, "Brier score of P(go) on " + held_out) +
         table_of(curve, &CurvePoint::log_loss, "log loss [nat] on " + held_out) +
         (curve.elsewhere > 0
              ? "models that other processes are still training: " + std::to_string(curve.elsewhere) + "\n"
              : "");
}

std::vector<std::filesystem::path> write_learning_curve(const std::filesystem::path& folder,
                                                        const LearningCurve& curve) {
  std::string csv = "trials,subset,forecaster,brier,log_loss_nat\n";
  for (const CurvePoint& point : curve.points)
    for (const std::string& name : names())
      csv += line("%zu,%zu,%s,%.17g,%.17g\n", point.trials, point.subset, name.c_str(), point.brier.at(name),
                  point.log_loss.at(name));
  std::vector<std::filesystem::path> files = {folder / "learning_curve.csv"};
  write_file_atomically(files[0], csv);
  if (!report::pictures_available() || curve.points.empty()) return files;
  files.push_back(folder / "learning_curve.png");
  report::write_charts(files.back(), "P(go) by the number of trials", {chart_of(curve)});
  return files;
}

}  // namespace gonogo::outcome
