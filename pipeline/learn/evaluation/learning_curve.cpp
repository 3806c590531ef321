#include "pipeline/learn/evaluation/learning_curve.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/line.h"
#include "base/lock.h"
#include "base/progress.h"
#include "learning/score/score.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/answer/predictor.h"
#include "pipeline/learn/evaluation/curve_subset.h"
#include "pipeline/learn/training/baselines.h"
#include "pipeline/learn/training/score_report.h"

namespace gonogo::learn {
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

std::vector<Point> points_of(const LearningCurveRequest& request, std::size_t left) {
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

/// Scores that a call with the same key left.
std::optional<Json> earlier_scores(const fs::path& file, const std::string& key) {
  if (!fs::exists(file)) return std::nullopt;
  Json found = Json::read(file);
  if (found.at("key").string() != key) return std::nullopt;
  return found.at("scores");
}

/// The next smaller number of trials of the curve; nothing for the smallest.
std::optional<std::size_t> number_before(const LearningCurveRequest& request, std::size_t trials) {
  std::optional<std::size_t> before;
  for (const std::size_t n : request.trials)
    if (n < trials && n > before.value_or(0)) before = n;
  return before;
}

/// Groups that train the model of a point. Those of an active curve follow from the model of the number before, which
/// is trained already.
std::vector<std::uint64_t> groups_of(const LearningCurveRequest& request, const Split& split, const Point& point) {
  const learning::TrainingTable& table = split.training.table;
  const std::optional<std::size_t> before = request.active ? number_before(request, point.trials) : std::nullopt;
  if (!before) return drawn_groups(table, point.trials, point.subset);
  const Point smaller{*before, point.subset};
  const Predictor predictor = Predictor::read(place_of(request, smaller) / "model.h5");
  const ModelAnswers answers{.p_go = [&](std::span<const double> x, std::span<double> p) { predictor.p_go(x, p); },
                             .novelty = [&](std::span<const double> x) { return predictor.novelty(x); }};
  return grown_groups(table, groups_of(request, split, smaller), point.trials, answers, point.subset);
}

/// Whether the models that a point's trials follow from are trained.
bool can_begin(const LearningCurveRequest& request, const Point& point, const std::string& key) {
  const std::optional<std::size_t> before = request.active ? number_before(request, point.trials) : std::nullopt;
  return !before || earlier_scores(place_of(request, {*before, point.subset}) / "scores.json", key);
}

/// Scores of the model, which an interrupted call may have trained already.
Json measured(const LearningCurveRequest& request, const Split& split, const Point& point, const std::string& key) {
  TrainRequest training = request.training;
  training.groups = groups_of(request, split, point);
  training.model = place_of(request, point) / "model.h5";
  const fs::path trained = place_of(request, point) / "trained.txt";
  if (!fs::exists(training.model) || !fs::exists(trained) || read_file(trained) != key) {
    train_model(training);
    write_file_atomically(trained, key);
  }
  const std::vector<int> happened = passable_labels(split.held_out);
  Json entry, brier = Json::object(), loss = Json::object();
  for (const auto& [name, p] : forecasts_of(training, split)) {
    brier[name] = learning::brier_score(p, happened);
    loss[name] = learning::log_loss(p, happened);
  }
  entry["trials"] = Json(std::uint64_t(point.trials));
  entry["subset"] = Json(std::uint64_t(point.subset));
  entry["brier"] = std::move(brier);
  entry["log_loss_nat"] = std::move(loss);
  return entry;
}

/// Scores the model of a point, if nobody has yet and no other process is at it. Returns true if this call did.
bool score(const LearningCurveRequest& request, const Split& split, const Point& point, const std::string& key) {
  const fs::path file = place_of(request, point) / "scores.json";
  if (earlier_scores(file, key) || !can_begin(request, point, key)) return false;
  const auto lock = FolderLock::if_free(file.parent_path());
  if (!lock || earlier_scores(file, key)) return false;
  Json kept;
  kept["key"] = key;
  kept["scores"] = measured(request, split, point, key);
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

Json learning_curve(const LearningCurveRequest& request) {
  if (request.training.hold_out == 0) throw InputError("learning curve: hold trials out to score the models on");
  const Split split = split_of(request.training);
  const std::vector<Point> points = points_of(request, split.training.table.row_count());
  const std::string key = curve_key(request);
  create_folder(request.folder);
  Progress progress("learning curve", "models", points.size());
  std::size_t done = 0, trained = 0;
  for (const Point& point : points) {
    trained += score(request, split, point, key);
    ++done;
    progress.update(done, "", done - trained);
  }
  Json curve;
  curve["key"] = key;
  curve["held_out"] = Json(std::uint64_t(split.held_out.row_count()));
  curve["points"] = Json::array();
  for (const Point& point : points)
    if (std::optional<Json> scores = earlier_scores(place_of(request, point) / "scores.json", key))
      curve["points"].push_back(*scores);
  curve["elsewhere"] = Json(std::uint64_t(points.size() - curve.at("points").items().size()));
  write_file_atomically(request.folder / "learning_curve.json", curve.dump(2) + "\n");
  return curve;
}

}  // namespace gonogo::learn
