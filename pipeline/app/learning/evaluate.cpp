#include <memory>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "learning/model/model.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/training/report.h"

namespace gonogo::app {
namespace {

struct EvaluateOptions {
  std::filesystem::path model, dataset, out, rows;  // dataset, out, rows: empty for none
};

/// Trials that shifted a family's odds of passing score better than those of a vehicle that it does not know.
std::string shift_note(const map::TrainedModel& model, const std::filesystem::path& dataset) {
  const Json* odds = model.predictor->model().provenance.find("vehicle_odds");
  if (!odds) return "";
  for (const Json& vehicle : odds->at("vehicles").items())
    if (vehicle.at("data_hash").string() == file_hash(dataset))
      return line(
          "these trials shifted the model's odds of passing, by %+.2f with those of other vehicles: they are not "
          "unseen\n",
          odds->at("shift_nat").number());
  return "";
}

void evaluate(const Globals& globals, const EvaluateOptions& options) {
  const bool held_out = !options.dataset.empty();
  if (!held_out && !options.rows.empty()) throw InputError("--rows are compared with held-out trials: give --dataset");
  const std::filesystem::path model = map::find_model(options.model);
  Json report;
  std::string text;
  outcome::Scores scores;
  std::vector<outcome::MissingPoint> missing;
  if (held_out) {
    const map::TrainedModel trained = map::read_trained_model(model);
    const map::AnsweredTrials asked = map::answer_trials(trained, options.dataset);
    outcome::Evaluation evaluation =
        outcome::evaluate_model(*asked.predictor, asked.trials, options.dataset.string(), options.rows);
    report = outcome::to_json(evaluation);
    text = outcome::evaluation_text(evaluation) + shift_note(trained, options.dataset);
    scores = std::move(evaluation.scores);
    missing = std::move(evaluation.missing);
  } else {
    report = learning::read_model(model).provenance;
    const outcome::TrainingReport training = outcome::read_report(report);
    text = outcome::report_text(training);
    scores = training.cross_validation;
  }
  if (!options.out.empty())
    for (const auto& file : outcome::write_evaluation(options.out, report, scores, missing))
      text += file.string() + "\n";
  print_result(globals, report, text);
}

}  // namespace

void add_evaluate_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "evaluate",
      "Score a model beside logistic and quadratic regression, a Gaussian process, a neural network and the base rate, "
      "on held-out trials or by cross-validation");
  const auto options = std::make_shared<EvaluateOptions>();
  add_named(*command, "--model", options->model, kModel, "Model file, or name of one that ships")->required();
  add_named(
      *command, "--dataset", options->dataset, kFile,
      "Held-out trials (dataset.h5); trials that the model was trained on are left out. For a family's model the "
      "machine of the vehicle that the trials drove answers. Without it, the cross-validation made when the model "
      "was trained is shown");
  add_named(*command, "--out", options->out, kFolder,
            "Folder for evaluation.json, reliability.csv, missing.csv and evaluation.png");
  add_named(*command, "--rows", options->rows, kFile,
            "Rows (CSV of gonogo sample or gonogo qubo import) that are also compared with the held-out trials");
  add_examples(
      *command,
      {"gonogo evaluate --model out/demo/model.h5", "gonogo train --dataset dataset.h5 --hold-out 1000 --out model.h5",
       "gonogo evaluate --model model.h5 --dataset dataset.h5  # on the 1000 held out",
       "gonogo evaluate --model hmmwv --dataset data/hmmwv_32mm_fresh/dataset.h5 --out out/scores --json",
       "gonogo evaluate --model out/family/model.h5 --dataset data/hmmwv_32mm_fresh/dataset.h5"});
  calls<evaluate>(*command, globals, options);
}

}  // namespace gonogo::app
