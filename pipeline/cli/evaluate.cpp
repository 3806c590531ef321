#include <memory>
#include <string>

#include "learning/model/model.h"
#include "pipeline/cli/command.h"
#include "pipeline/learn/evaluate_model.h"
#include "pipeline/learn/score_report.h"
#include "pipeline/learn/train_model.h"

namespace gonogo::pipeline::cli {
namespace {

std::string held_out_text(const Json& report) {
  return report.at("trials").dump() + " trials that the model has not seen (" + report.at("left_out_unknown").dump() +
         " failed and " + report.at("left_out_trained_on").dump() +
         " trained on are left out); log loss over all outcomes " + report.at("outcome_log_loss_nat").dump() +
         " nat\n" + scores_text(report.at("scores"));
}

}  // namespace

void add_evaluate_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "evaluate",
      "Score a model beside logistic regression and the base rate, on held-out trials or by cross-validation");
  auto model = std::make_shared<std::string>(), dataset = std::make_shared<std::string>();
  command->add_option("--model", *model, "Model file")->required();
  command->add_option(
      "--dataset", *dataset,
      "Held-out trials (dataset.h5); trials that the model was trained on are left out. Without it, the "
      "cross-validation made when the model was trained is shown");
  command->footer(
      "Examples:\n  gonogo evaluate --model out/demo/model.h5\n"
      "  gonogo evaluate --model out/demo/model.h5 --dataset out/held_out/dataset.h5 --json");
  command->callback([model, dataset, &globals] {
    if (dataset->empty()) {
      const Json report = learning::read_model(*model).provenance;
      print_result(globals, report, report_text(report));
    } else {
      const Json report = evaluate_model(*model, *dataset);
      print_result(globals, report, held_out_text(report));
    }
  });
}

}  // namespace gonogo::pipeline::cli
