#include "pipeline/outcome/answer/infer.h"

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/predictor.h"

namespace gonogo::app {
namespace {

struct InferOptions {
  std::string model, outcome, csv, out;
  std::vector<std::string> set;
  bool reconstruct = false, interactive = false;
};

void infer(const InferOptions& options, const Globals& globals) {
  const int ways = !options.csv.empty() + options.interactive;
  if (ways > 1 || (ways == 1 && (!options.set.empty() || !options.outcome.empty())))
    throw InputError("infer: give one point (--set, --outcome), or --csv, or --interactive");
  if (options.csv.empty() != options.out.empty()) throw InputError("infer: --csv and --out belong together");
  const outcome::Predictor predictor = outcome::Predictor::read(map::find_model(options.model));
  if (options.interactive) return outcome::converse(predictor, std::cin, std::cout);
  if (!options.csv.empty()) {
    const std::size_t rows = outcome::infer_csv(predictor, options.csv, options.out);
    if (rows == 0) log_line(options.csv, "holds a header and no points, so that the answers are a header alone");
    Json result;
    result["rows"] = Json(std::uint64_t(rows));
    result["out"] = options.out;
    result[campaign::kGravityKey] = outcome::gravity_of(predictor.model());
    return print_result(globals, result,
                        std::to_string(rows) + " points answered in " + options.out +
                            line(", gravity of the trials %.4g m/s2\n", outcome::gravity_of(predictor.model())));
  }
  outcome::Question question{outcome::to_variables(outcome::parse_named_values(options.set)), std::nullopt,
                             options.reconstruct};
  if (!options.outcome.empty()) question.outcome = outcome::outcome_named(options.outcome);
  const outcome::Answer answer = outcome::answer_question(predictor, question);
  print_result(globals, outcome::to_json(answer), outcome::answer_text(answer));
}

}  // namespace

void add_infer_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("infer", "P(outcome) at one point or many; unknown variables are summed out or reconstructed");
  auto options = std::make_shared<InferOptions>();
  add_named(*command, "--model", options->model, kModel, "Model file, or name of one that ships")->required();
  add_named(*command, "--set", options->set, kSetting,
            "Value of a variable, in the unit of the contract; may be repeated");
  command->add_flag("--reconstruct", options->reconstruct,
                    "Also answer with the unknown variables: mean, spread, all bins");
  add_named(*command, "--outcome", options->outcome, "OUTCOME",
            "Take this outcome as known and answer with the unknown variables");
  add_named(*command, "--csv", options->csv, kFile, "Points with a header of variables; empty cells are unknown");
  add_named(*command, "--out", options->out, kFile, "CSV to write for --csv: the same columns and the answers");
  command->add_flag("--interactive", options->interactive, "Ask line by line");
  add_examples(*command, {"gonogo infer --model hmmwv --set slope_along=12 friction_angle=32 payload=500",
                          "gonogo infer --model out/demo/model.h5 --set slope_along=20 --outcome no_go/traction",
                          "gonogo infer --model out/demo/model.h5 --csv points.csv --out answers.csv"});
  command->callback([options, &globals] { infer(*options, globals); });
}

}  // namespace gonogo::app
