#include "base/error.h"
#include "learning/model/model.h"
#include "pipeline/app/work/work.h"
#include "pipeline/learn/evaluation/evaluate_model.h"
#include "pipeline/learn/evaluation/evaluation_checks.h"
#include "pipeline/learn/evaluation/joint_scores.h"
#include "pipeline/learn/evaluation/reconstruction.h"
#include "pipeline/learn/training/score_report.h"
#include "pipeline/learn/training/train_model.h"
#include "pipeline/map/model/trained_model.h"

namespace gonogo::app {
namespace {

std::string held_out_text(const Json& report) {
  return report.at("trials").dump() + " trials that the model has not seen (" + report.at("left_out_unknown").dump() +
         " failed and " + report.at("left_out_trained_on").dump() +
         " trained on are left out); log loss over all outcomes " + report.at("outcome_log_loss_nat").dump() +
         " nat\n" + learn::scores_text(report.at("scores")) + learn::missing_text(report.at("missing")) +
         learn::reconstruction_text(report.at("reconstruction")) + learn::joint_text(report.at("joint")) +
         learn::checks_text(report.at("checks"));
}

}  // namespace

void evaluate_work(const Globals& globals, const EvaluateOptions& options) {
  const bool held_out = !options.dataset.empty();
  if (!held_out && !options.rows.empty()) throw InputError("--rows are compared with held-out trials: give --dataset");
  const std::filesystem::path model = map::find_model(options.model);
  const Json report =
      held_out ? learn::evaluate_model(model, options.dataset, options.rows) : learning::read_model(model).provenance;
  std::string text = held_out ? held_out_text(report) : learn::report_text(report);
  if (!options.out.empty()) {
    const Json& scores = report.at(held_out ? "scores" : "cross_validation");
    for (const auto& file : learn::write_evaluation(options.out, report, scores)) text += file.string() + "\n";
  }
  print_result(globals, report, text);
}

}  // namespace gonogo::app
