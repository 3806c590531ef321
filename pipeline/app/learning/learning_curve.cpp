#include <memory>

#include "pipeline/app/cli/work.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/outcome/active/learning_curve.h"
#include "pipeline/outcome/prior/other_trials.h"

namespace gonogo::app {
namespace {

struct LearningCurveOptions {
  std::vector<std::filesystem::path> datasets;         // of any fidelities
  std::filesystem::path study, out;                    // study: empty for defaults
  std::optional<std::uint64_t> seed;                   // nothing: the study's, or 1
  std::vector<std::size_t> trials = {100, 300, 1000};  // numbers to train on
  std::size_t hold_out = 1000, subsets = 5;
  bool active = false;
  FamilyChoice family;
};

void score_curve(const Globals& globals, const LearningCurveOptions& options) {
  outcome::LearningCurveRequest request;
  const std::vector<std::filesystem::path> datasets = outcome::finest_first(options.datasets);
  request.training.dataset = datasets.front();
  request.training.others.assign(datasets.begin() + 1, datasets.end());
  if (options.family.from_family)
    request.training.forecast = map::family_forecast(options.family.model, request.training.dataset);
  request.training.hold_out = options.hold_out;
  request.trials = options.trials;
  request.subsets = options.subsets;
  request.active = options.active;
  request.folder = options.out;
  outcome::take_study(request.training, options.study, options.seed);
  const outcome::LearningCurve curve = outcome::learning_curve(request);
  std::string text = outcome::learning_curve_text(curve);
  for (const auto& file : outcome::write_learning_curve(options.out, curve)) text += file.string() + "\n";
  print_result(globals, outcome::to_json(curve), text);
}

}  // namespace

void add_learning_curve_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "learning-curve", "Train on 100, 300, ... trials of a dataset and score model and baselines on held-out ones");
  const auto options = std::make_shared<LearningCurveOptions>();
  add_named(*command, "--dataset", options->datasets, kFile,
            "Trials (dataset.h5); of several, the finest count and the others help")
      ->required();
  add_named(*command, "--study", options->study, kStudy,
            "Study whose sections \"learning\" and \"design\" apply; defaults without");
  add_named(*command, "--out", options->out, kFolder,
            "Folder for models, learning_curve.json, learning_curve.csv and learning_curve.png")
      ->required();
  command->add_option("--trials", options->trials, "Numbers of trials to train on")
      ->delimiter(',')
      ->capture_default_str();
  add_number(*command, "--subsets", options->subsets, {1, 100},
             "Subsets of each number; all trials that are left are one");
  add_number(*command, "--hold-out", options->hold_out, {1, 1000000}, "Valid trials that score, as in gonogo train");
  command->add_flag("--active", options->active,
                    "Draw the trials of the smallest number only; to each next one add those that an active design "
                    "would take");
  add_family(*command, options->family,
             "Start from the forecast of the model of the vehicle's family; with --active the smallest number follows "
             "it, too");
  command->add_option("--seed", options->seed, "Seed; the study's when left out, without a study 1")->check(kSeed);
  add_examples(
      *command,
      {"gonogo learning-curve --dataset data/quarter_wheel_32mm/dataset.h5 \\\n"
       "      --study configs/studies/quarter_wheel_32mm.json --trials 100,300,1000,3004 --out curve",
       "gonogo learning-curve --dataset out/buggy/dataset.h5 --from-family --active --trials 32,64 --hold-out 300 "
       "--out curve"},
      "The same command goes on after an interruption. Started several times, the processes share the models.");
  calls<score_curve>(*command, globals, options);
}

}  // namespace gonogo::app
