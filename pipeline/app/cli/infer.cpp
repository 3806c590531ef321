#include "pipeline/learn/answer/infer.h"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/learn/answer/model_gravity.h"
#include "pipeline/learn/answer/named_values.h"
#include "pipeline/map/model/trained_model.h"

namespace gonogo::app {
namespace {

struct Options {
  std::string model, outcome, csv, out;
  std::vector<std::string> set;
  bool reconstruct = false, interactive = false;
};

void infer(const Options& options, const Globals& globals) {
  const int ways = !options.csv.empty() + options.interactive;
  if (ways > 1 || (ways == 1 && (!options.set.empty() || !options.outcome.empty())))
    throw InputError("infer: give one point (--set, --outcome), or --csv, or --interactive");
  if (options.csv.empty() != options.out.empty()) throw InputError("infer: --csv and --out belong together");
  const learn::Predictor predictor = learn::Predictor::read(map::find_model(options.model));
  if (options.interactive) return learn::converse(predictor, std::cin, std::cout);
  if (!options.csv.empty()) {
    const std::size_t rows = learn::infer_csv(predictor, options.csv, options.out);
    Json result;
    result["rows"] = Json(std::uint64_t(rows));
    result["out"] = options.out;
    result[campaign::kGravityKey] = learn::gravity_of(predictor.model());
    return print_result(globals, result,
                        std::to_string(rows) + " points answered in " + options.out +
                            line(", gravity of the trials %.4g m/s2\n", learn::gravity_of(predictor.model())));
  }
  learn::Question question{learn::to_variables(learn::parse_named_values(options.set)), std::nullopt,
                           options.reconstruct};
  if (!options.outcome.empty()) question.outcome = learn::outcome_named(options.outcome);
  const Json answer = learn::answer_question(predictor, question);
  print_result(globals, answer, learn::answer_text(answer));
}

}  // namespace

void add_infer_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("infer", "P(outcome) at one point or many; unknown variables are summed out or reconstructed");
  auto options = std::make_shared<Options>();
  command->add_option("--model", options->model, "Model file, or name of one that ships")
      ->type_name(kModel)
      ->required();
  command->add_option("--set", options->set, "Value of a variable, in the unit of the contract; may be repeated")
      ->type_name(kSetting);
  command->add_flag("--reconstruct", options->reconstruct,
                    "Also answer with the unknown variables: mean, spread, all bins");
  command->add_option("--outcome", options->outcome, "Take this outcome as known and answer with the unknown variables")
      ->type_name("OUTCOME");
  command->add_option("--csv", options->csv, "Points with a header of variables; empty cells are unknown")
      ->type_name(kFile);
  command->add_option("--out", options->out, "CSV to write for --csv: the same columns and the answers")
      ->type_name(kFile);
  command->add_flag("--interactive", options->interactive, "Ask line by line");
  add_examples(*command, {"gonogo infer --model hmmwv --set slope_along=12 friction_angle=32 payload=500",
                          "gonogo infer --model out/demo/model.h5 --set slope_along=20 --outcome no_go/traction",
                          "gonogo infer --model out/demo/model.h5 --csv points.csv --out answers.csv"});
  command->callback([options, &globals] { infer(*options, globals); });
}

}  // namespace gonogo::app
