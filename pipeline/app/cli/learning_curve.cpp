#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_learning_curve_command(CLI::App& app, const Globals& globals, const Work<LearningCurveOptions>& work) {
  CLI::App* command = app.add_subcommand(
      "learning-curve", "Train on 100, 300, ... trials of a dataset and score model and baselines on held-out ones");
  const auto options = std::make_shared<LearningCurveOptions>();
  command
      ->add_option("--dataset", options->datasets,
                   "Trials (dataset.h5); of several, each of another fidelity, the finest count and the others help")
      ->type_name(kFile)
      ->required();
  command
      ->add_option("--study", options->study,
                   "Study whose sections \"learning\" and \"design\" apply; defaults without")
      ->type_name(kStudy);
  command
      ->add_option("--out", options->out,
                   "Folder for models, learning_curve.json, learning_curve.csv and learning_curve.png")
      ->type_name(kFolder)
      ->required();
  command->add_option("--trials", options->trials, "Numbers of trials to train on")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--subsets", options->subsets, "Subsets of each number; all trials that are left are one")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--hold-out", options->hold_out, "Valid trials that score, as in gonogo train")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_flag("--active", options->active,
                    "Draw the trials of the smallest number only; to each next one add those that an active design "
                    "would take");
  command->add_option("--seed", options->seed, "Seed; the study's when left out, without a study 1")->check(kSeed);
  add_examples(
      *command,
      {"gonogo learning-curve --dataset data/quarter_wheel_32mm/dataset.h5 \\\n"
       "      --study configs/studies/quarter_wheel_32mm.json --trials 100,300,1000,3004 --out curve"},
      "The same command goes on after an interruption. Started several times, the processes share the models.");
  command->callback([options, work, &globals] { work(globals, *options); });
}

}  // namespace gonogo::app
