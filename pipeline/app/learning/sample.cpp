#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/joint_summary.h"
#include "pipeline/outcome/sampling/rows_file.h"

namespace gonogo::app {
namespace {

struct SampleOptions {
  std::string model, outcome, from = "machine", out;
  std::vector<std::string> set;
  bool middles = false;
  outcome::RowRequest request;
};

void sample(const SampleOptions& options, const Globals& globals) {
  const std::string ending = std::filesystem::path(options.out).extension().string();
  if (ending != ".csv" && ending != ".h5" && ending != ".hdf5")
    throw InputError("--out " + options.out + ": rows are written as .csv or .h5; give one of these extensions");
  const outcome::Predictor predictor = outcome::Predictor::read(map::find_model(options.model));
  outcome::RowRequest request = options.request;
  request.known = outcome::to_variables(outcome::parse_named_values(options.set));
  if (!options.outcome.empty()) request.outcome = outcome::outcome_named(options.outcome);
  request.source = options.from == "prior" ? outcome::RowSource::prior : outcome::RowSource::machine;
  request.inside = !options.middles;
  const outcome::SampledRows rows = outcome::sample_rows(predictor, request);
  const outcome::RowsReport report = outcome::rows_report(predictor, request, rows);
  outcome::write_rows(options.out, predictor, rows, report);
  Json json = outcome::to_json(report);
  json["out"] = options.out;
  std::string text = outcome::rows_text(report) + options.out + "\n";
  if (request.source == outcome::RowSource::machine) {
    const std::string warning = outcome::joint_warning(predictor.model());
    if (!warning.empty()) json["warning"] = warning, text += "warning: " + warning + "\n";
  }
  print_result(globals, json, text);
}

void add_chain_options(CLI::App* command, outcome::RowRequest& request) {
  add_number(*command, "--chains", request.chains, {1, 100000},
             "Chains; parts of the rows where each is drawn on its own");
  add_number(*command, "--burn-in", request.burn_in, {0, 100000000}, "Sweeps before the first row of a chain");
  add_number(*command, "--every", request.every, {1, 100000000}, "Sweeps between rows of a chain");
  add_number(*command, "--rungs", request.rungs, {2, 64}, "tempering: temperatures");
  add_named(*command, "--graph", request.device.graph.name, "GRAPH", "emulator: its graph, as for gonogo qubo embed")
      ->capture_default_str();
  add_number(*command, "--dead-share", request.device.graph.dead_share, {0.0, 0.5}, "emulator: share of dead qubits");
  command->add_option("--dead-seed", request.device.graph.dead_seed, "emulator: seed of the dead qubits")
      ->check(kSeed)
      ->capture_default_str();
}

}  // namespace

void add_sample_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("sample", "Draw rows of variables and outcome from a model");
  auto options = std::make_shared<SampleOptions>();
  add_named(*command, "--model", options->model, kModel, "Model file, or name of one that ships")->required();
  add_named(*command, "--out", options->out, kFile, "File of rows to write: .csv or .h5")->required();
  add_number(*command, "--rows", options->request.rows, {1, 100000000}, "Number of rows");
  add_named(*command, "--set", options->set, kSetting, "Value of a variable, kept in every row; may be repeated");
  add_named(*command, "--outcome", options->outcome, "OUTCOME", "Rows of this outcome only");
  add_named(*command, "--from", options->from, one_of({"machine", "prior"}),
            "machine: its joint distribution; prior: variables from the design's distribution, the outcome from "
            "P(outcome | variables)")
      ->check(CLI::IsMember({"machine", "prior"}))
      ->capture_default_str();
  add_named(*command, "--sampler", options->request.sampler, one_of(outcome::row_samplers()),
            "Of the machine. auto: exact where the rows can be summed, otherwise tempering")
      ->check(CLI::IsMember(outcome::row_samplers()))
      ->capture_default_str();
  add_chain_options(command, options->request);
  command->add_flag("--middles", options->middles, "Middles of bins instead of values inside them");
  command->add_option("--seed", options->request.seed, "Seed")->check(kSeed)->capture_default_str();
  add_examples(*command,
               {"gonogo sample --model out/demo/model.h5 --rows 1000 --out rows.csv",
                "gonogo sample --model hmmwv --set slope_along=12 --set friction_angle=32 --out rows.h5",
                "gonogo sample --model out/demo/model.h5 --outcome no_go/traction --from prior --out rows.csv"});
  command->callback([options, &globals] { sample(*options, globals); });
}

}  // namespace gonogo::app
