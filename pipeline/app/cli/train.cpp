#include <memory>
#include <string>

#include "pipeline/app/cli/command.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/learn/training/train_members.h"
#include "pipeline/learn/training/train_model.h"

namespace gonogo::app {
namespace {

struct Options {
  std::string dataset, study, out;
  std::uint64_t seed = 1;
  int members = 0;
  std::size_t hold_out = 0;
};

learn::TrainRequest to_request(const Options& options, bool seed_given) {
  learn::TrainRequest request{.dataset = options.dataset,
                              .model = options.out,
                              .seed = options.seed,
                              .learning = {},
                              .design = {},
                              .hold_out = options.hold_out};
  if (options.study.empty()) return request;
  const campaign::Study study = campaign::read_study(options.study);
  if (!seed_given) request.seed = study.seed;
  request.learning = study.config.object_if("learning");
  request.design = study.config.object_if("design");
  return request;
}

}  // namespace

void add_train_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("train", "Train a model of the outcomes on simulated trials");
  auto options = std::make_shared<Options>();
  command->add_option("--dataset", options->dataset, "Trials to train on (dataset.h5)")->required();
  command->add_option("--study", options->study,
                      "Study whose sections \"learning\" and \"design\" apply; defaults without");
  command->add_option("--out", options->out, "Model file to write")->required();
  command
      ->add_option("--hold-out", options->hold_out,
                   "Valid trials that are not trained on, replicates together, drawn from the seed; gonogo evaluate "
                   "on the same dataset scores them")
      ->capture_default_str();
  CLI::Option* seed =
      command->add_option("--seed", options->seed, "Seed; the study's when left out")->capture_default_str();
  command
      ->add_option("--members", options->members,
                   "Also train so many models on reweighted trials, for the spread of the model in maps")
      ->check(CLI::Range(0, 100));
  command->footer(
      "Example:\n  gonogo train --dataset out/demo/dataset.h5 --study configs/studies/demo.json --out "
      "out/demo/model.h5");
  command->callback([options, seed, &globals] {
    const learn::TrainRequest request = to_request(*options, seed->count() > 0);
    Json report = learn::train_model(request);
    const std::string text = learn::report_text(report);
    report["model"] = options->out;
    if (options->members > 0) {
      Json members = Json::array();
      for (const auto& file : learn::train_members(request, options->members)) members.push_back(Json(file.string()));
      report["members"] = members;
    }
    print_result(globals, report, text);
  });
}

}  // namespace gonogo::app
