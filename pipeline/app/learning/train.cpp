#include <memory>

#include "pipeline/app/cli/work.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/outcome/prior/other_trials.h"
#include "pipeline/outcome/training/train_model.h"

namespace gonogo::app {
namespace {

struct TrainOptions {
  std::vector<std::filesystem::path> datasets;  // of any fidelities
  std::filesystem::path study, out;             // study: empty for defaults
  std::optional<std::uint64_t> seed;            // nothing: the study's, or 1
  int members = 0;                              // models on reweighted trials
  std::size_t hold_out = 0;                     // trials
  std::vector<std::filesystem::path> vehicles;  // trials of vehicles of a family
  FamilyChoice family;
};

outcome::TrainRequest to_request(const TrainOptions& options) {
  const std::vector<std::filesystem::path> datasets = outcome::finest_first(options.datasets);
  const auto forecast =
      options.family.from_family ? map::family_forecast(options.family.model, datasets.front()) : nullptr;
  outcome::TrainRequest request{.dataset = datasets.front(),
                                .model = options.out,
                                .hold_out = options.hold_out,
                                .others = {datasets.begin() + 1, datasets.end()},
                                .forecast = forecast,
                                .members_follow = options.members > 0};
  outcome::take_study(request, options.study, options.seed);
  request.vehicles = map::vehicle_trials(request.dataset, request.design, options.vehicles);
  return request;
}

void train(const Globals& globals, const TrainOptions& options) {
  const outcome::TrainRequest request = to_request(options);
  const outcome::TrainingReport trained = outcome::train_model(request);
  Json report = outcome::to_json(trained);
  report["model"] = options.out.string();
  if (options.members > 0) {
    Json members = Json::array();
    for (const auto& file : outcome::train_members(request, options.members)) members.push_back(Json(file.string()));
    report["members"] = members;
  }
  print_result(globals, report, outcome::report_text(trained));
}

}  // namespace

void add_train_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("train", "Train a model of the outcomes on simulated trials");
  const auto options = std::make_shared<TrainOptions>();
  add_named(*command, "--dataset", options->datasets, kFile,
            "Trials to train on (dataset.h5); of several, the model answers at the finest and the others help")
      ->required();
  add_named(*command, "--study", options->study, kStudy,
            "Study whose sections \"learning\" and \"design\" apply; defaults without");
  add_named(*command, "--out", options->out, kFile, "Model file to write")->required();
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
  add_named(
      *command, "--vehicles", options->vehicles, kFile,
      "Trials of vehicles of the family that --dataset drove, each driven by itself: they shift the family's odds "
      "of passing to theirs");
  add_family(*command, options->family,
             "Start from the forecast of the model of the vehicle's family, which own trials correct");
  add_examples(
      *command,
      {"gonogo train --dataset out/demo/dataset.h5 --study configs/studies/quarter_wheel_90mm.json --out out/coarse.h5",
       "gonogo train --dataset out/fine/dataset.h5 out/coarse/dataset.h5 --out out/fine/model.h5",
       "gonogo train --dataset out/family/dataset.h5 --vehicles data/viper_32mm/dataset.h5 --out out/family/model.h5",
       "gonogo train --dataset out/buggy/dataset.h5 --from-family --out out/buggy/model.h5"});
  calls<train>(*command, globals, options);
}

}  // namespace gonogo::app
