#include "pipeline/learn/evaluation/learning_curve.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"
#include "base/progress.h"
#include "learning/score/score.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/answer/predictor.h"
#include "pipeline/learn/training/baselines.h"
#include "pipeline/learn/training/score_report.h"

namespace gonogo::learn {
namespace {

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
  std::vector<Point> points;
  for (std::size_t trials : request.trials) {
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
  thin(fewer, request.trials, request.subset);
  std::map<std::string, std::vector<double>> forecasts =
      fit_baselines(fewer.table, passable_labels(fewer.table)).forecasts(split.held_out.variables);
  std::vector<double> p(split.held_out.row_count());
  Predictor::read(request.model).p_go(split.held_out.variables, p);
  for (double& x : p) x = std::clamp(x, 1e-12, 1 - 1e-12);
  forecasts["model"] = p;
  return forecasts;
}

Json measured(const LearningCurveRequest& request, const Split& split, const Point& point) {
  TrainRequest training = request.training;
  training.trials = point.trials;
  training.subset = point.subset;
  training.model = request.folder / line("trials_%zu_subset_%zu.h5", point.trials, point.subset);
  train_model(training);
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

/// What an earlier call with the same key left, or an empty curve.
Json earlier_curve(const std::filesystem::path& file, const std::string& key) {
  if (std::filesystem::exists(file))
    if (Json found = Json::read(file); found.at("key").string() == key) return found;
  Json fresh;
  fresh["key"] = key;
  fresh["points"] = Json::array();
  return fresh;
}

bool holds(const Json& curve, const Point& point) {
  for (const Json& entry : curve.at("points").items())
    if (std::size_t(entry.at("trials").integer()) == point.trials &&
        std::size_t(entry.at("subset").integer()) == point.subset)
      return true;
  return false;
}

}  // namespace

Json learning_curve(const LearningCurveRequest& request) {
  if (request.training.hold_out == 0) throw InputError("learning curve: hold trials out to score the models on");
  const Split split = split_of(request.training);
  const std::vector<Point> points = points_of(request, split.training.table.row_count());
  create_folder(request.folder);
  const std::filesystem::path file = request.folder / "learning_curve.json";
  Json curve = earlier_curve(file, work_key(request.training, trainable_settings(request.training.learning)));
  curve["held_out"] = Json(std::uint64_t(split.held_out.row_count()));
  Progress progress("learning curve", "models", points.size());
  std::size_t done = 0, reused = 0;
  for (const Point& point : points) {
    if (holds(curve, point)) {
      progress.update(++done, "", ++reused);
      continue;
    }
    curve["points"].push_back(measured(request, split, point));
    write_file_atomically(file, curve.dump(2) + "\n");
    progress.update(++done, "", reused);
  }
  return curve;
}

}  // namespace gonogo::learn
