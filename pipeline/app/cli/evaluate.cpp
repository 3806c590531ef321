#include <memory>
#include <string>

#include "learning/model/model.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/learn/evaluation/evaluate_model.h"
#include "pipeline/learn/evaluation/evaluation_checks.h"
#include "pipeline/learn/training/score_report.h"
#include "pipeline/learn/training/train_model.h"

namespace gonogo::app {
namespace {

std::string held_out_text(const Json& report) {
  return report.at("trials").dump() + " trials that the model has not seen (" + report.at("left_out_unknown").dump() +
         " failed and " + report.at("left_out_trained_on").dump() +
         " trained on are left out); log loss over all outcomes " + report.at("outcome_log_loss_nat").dump() +
         " nat\n" + learn::scores_text(report.at("scores")) + learn::missing_text(report.at("missing")) +
         learn::checks_text(report.at("checks"));
}

}  // namespace

void add_evaluate_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "evaluate",
      "Score a model beside logistic regression, a neural network and the base rate, on held-out trials or by "
      "cross-validation");
  auto model = std::make_shared<std::string>(), dataset = std::make_shared<std::string>();
  auto out = std::make_shared<std::string>();
  command->add_option("--model", *model, "Model file")->required();
  command->add_option(
      "--dataset", *dataset,
      "Held-out trials (dataset.h5); trials that the model was trained on are left out. Without it, the "
      "cross-validation made when the model was trained is shown");
  command->add_option("--out", *out, "Folder for evaluation.json, reliability.csv, missing.csv and evaluation.png");
  command->footer(
      "Examples:\n  gonogo evaluate --model out/demo/model.h5\n"
      "  gonogo train --dataset dataset.h5 --hold-out 1000 --out model.h5 && gonogo evaluate --model model.h5 "
      "--dataset "
      "dataset.h5\n"
      "  gonogo evaluate --model out/demo/model.h5 --dataset out/held_out/dataset.h5 --out out/scores --json");
  command->callback([model, dataset, out, &globals] {
    const bool held_out = !dataset->empty();
    const Json report = held_out ? learn::evaluate_model(*model, *dataset) : learning::read_model(*model).provenance;
    std::string text = held_out ? held_out_text(report) : learn::report_text(report);
    if (!out->empty())
      for (const auto& file :
           learn::write_evaluation(*out, report, report.at(held_out ? "scores" : "cross_validation")))
        text += file.string() + "\n";
    print_result(globals, report, text);
  });
}

}  // namespace gonogo::app
