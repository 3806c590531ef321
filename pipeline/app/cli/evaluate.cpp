#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_evaluate_command(CLI::App& app, const Globals& globals, const Work<EvaluateOptions>& work) {
  CLI::App* command = app.add_subcommand(
      "evaluate",
      "Score a model beside logistic and quadratic regression, a Gaussian process, a neural network and the base rate, "
      "on held-out trials or by cross-validation");
  const auto options = std::make_shared<EvaluateOptions>();
  command->add_option("--model", options->model, "Model file, or name of one that ships")
      ->type_name(kModel)
      ->required();
  command
      ->add_option("--dataset", options->dataset,
                   "Held-out trials (dataset.h5); trials that the model was trained on are left out. Without it, the "
                   "cross-validation made when the model was trained is shown")
      ->type_name(kFile);
  command
      ->add_option("--out", options->out, "Folder for evaluation.json, reliability.csv, missing.csv and evaluation.png")
      ->type_name(kFolder);
  command
      ->add_option("--rows", options->rows,
                   "Rows (CSV of gonogo sample or gonogo qubo import) that are also compared with the held-out trials")
      ->type_name(kFile);
  add_examples(*command, {"gonogo evaluate --model out/demo/model.h5",
                          "gonogo train --dataset dataset.h5 --hold-out 1000 --out model.h5",
                          "gonogo evaluate --model model.h5 --dataset dataset.h5  # on the 1000 held out",
                          "gonogo evaluate --model hmmwv --dataset data/hmmwv_32mm/fresh.h5 --out out/scores --json"});
  command->callback([options, work, &globals] { work(globals, *options); });
}

}  // namespace gonogo::app
