// Of include/gonogo/learn.h: what needs LibTorch.
#include <gonogo/learn.h>
#include "base/files/shipped.h"
#include "pipeline/face/inside.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/training/train_model.h"

namespace gonogo::api {
namespace {

std::vector<Score> scores_of(const outcome::Scores& scores) {
  std::vector<Score> result;
  for (const auto& [name, s] : scores.of)
    result.push_back({.of = name,
                      .brier = {s.brier.low, s.brier.high},
                      .brier_score = s.brier.value,
                      .log_loss = s.log_loss.value,
                      .accuracy = s.accuracy,
                      .calibration_error = s.calibration_error});
  return result;
}

outcome::TrainRequest request_of(const TrainRequest& request) {
  outcome::TrainRequest result;
  result.dataset = request.dataset;
  result.model = request.model;
  result.others = request.others;
  result.hold_out = request.hold_out;
  result.members_follow = request.members > 0;
  if (request.family) result.forecast = map::family_forecast(*request.family, request.dataset);
  const auto study = request.study.empty() ? std::filesystem::path() : shipped_file("studies", "study", request.study);
  outcome::take_study(result, study, request.seed);
  result.vehicles = map::vehicle_trials(result.dataset, result.design, request.vehicles);
  return result;
}

}  // namespace

TrainReport train(const TrainRequest& request) {
  return guarded([&] {
    const outcome::TrainRequest asked = request_of(request);
    const outcome::TrainingReport r = outcome::train_model(asked);
    TrainReport result{.trials = r.counts.trials,
                       .trained_on = r.counts.trained_on,
                       .unknown = r.counts.unknown,
                       .held_out = r.counts.held_out,
                       .epochs = r.epochs,
                       .scores = scores_of(r.cross_validation),
                       .text = outcome::report_text(r)};
    if (request.members > 0) result.members = outcome::train_members(asked, request.members);
    return result;
  });
}

Evaluation evaluate(const std::string& model, const std::filesystem::path& dataset) {
  return guarded([&] {
    const map::TrainedModel trained = map::read_trained_model(map::find_model(model));
    const map::AnsweredTrials asked = map::answer_trials(trained, dataset);
    const outcome::Evaluation e = outcome::evaluate_model(*asked.predictor, asked.trials, dataset.string());
    Evaluation result{.trials = e.trials,
                      .trained_on = e.trained_on,
                      .unknown = e.unknown,
                      .scores = scores_of(e.scores),
                      .text = outcome::evaluation_text(e)};
    for (const outcome::Criterion& c : e.checks) result.checks.push_back({c.what, c.holds, c.value, c.limit});
    return result;
  });
}

}  // namespace gonogo::api
