#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_train_command(CLI::App& app, const Globals& globals, const Work<TrainOptions>& work) {
  CLI::App* command = app.add_subcommand("train", "Train a model of the outcomes on simulated trials");
  const auto options = std::make_shared<TrainOptions>();
  command
      ->add_option("--dataset", options->datasets,
                   "Trials to train on (dataset.h5); of several, each of another fidelity, the model answers at the "
                   "finest and the others help")
      ->type_name(kFile)
      ->required();
  command
      ->add_option("--study", options->study,
                   "Study whose sections \"learning\" and \"design\" apply; defaults without")
      ->type_name(kStudy);
  command->add_option("--out", options->out, "Model file to write")->type_name(kFile)->required();
  command
      ->add_option("--hold-out", options->hold_out,
                   "Valid trials that are not trained on, replicates together, drawn from the seed; gonogo evaluate "
                   "on the same dataset scores them")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed; the study's when left out, without a study 1")->check(kSeed);
  command
      ->add_option("--members", options->members,
                   "Also train so many models on reweighted trials, for the spread of the model in maps")
      ->check(CLI::Range(0, 100));
  add_examples(
      *command,
      {"gonogo train --dataset out/demo/dataset.h5 --study configs/studies/quarter_wheel_90mm.json --out out/coarse.h5",
       "gonogo train --dataset out/fine/dataset.h5 out/coarse/dataset.h5 --out out/fine/model.h5"});
  command->callback([options, work, &globals] { work(globals, *options); });
}

}  // namespace gonogo::app
