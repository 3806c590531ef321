#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/learn/answer/infer.h"
#include "pipeline/learn/answer/named_values.h"
#include "pipeline/learn/sampling/sample_rows.h"
#include "pipeline/map/model/trained_model.h"

namespace gonogo::app {
namespace {

struct Options {
  std::string model, outcome, from = "machine", out;
  std::vector<std::string> set;
  bool middles = false;
  learn::RowRequest request;
};

void sample(const Options& options, const Globals& globals) {
  const std::string ending = std::filesystem::path(options.out).extension().string();
  if (ending != ".csv" && ending != ".h5" && ending != ".hdf5")
    throw InputError("--out " + options.out + ": rows are written as .csv or .h5; give one of these extensions");
  const learn::Predictor predictor = learn::Predictor::read(map::find_model(options.model));
  learn::RowRequest request = options.request;
  request.known = learn::to_variables(learn::parse_named_values(options.set));
  if (!options.outcome.empty()) request.outcome = learn::outcome_named(options.outcome);
  request.source = options.from == "prior" ? learn::RowSource::prior : learn::RowSource::machine;
  request.inside = !options.middles;
  const learn::SampledRows rows = learn::sample_rows(predictor, request);
  Json report = learn::rows_report(predictor, request, rows);
  learn::write_rows(options.out, predictor, rows, report);
  report["out"] = options.out;
  print_result(globals, report, learn::rows_text(report) + options.out + "\n");
}

void add_chain_options(CLI::App* command, learn::RowRequest& request) {
  command->add_option("--chains", request.chains, "Chains; parts of the rows where each is drawn on its own")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--burn-in", request.burn_in, "Sweeps before the first row of a chain")
      ->check(CLI::Range(0, 100000000))
      ->capture_default_str();
  command->add_option("--every", request.every, "Sweeps between rows of a chain")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  command->add_option("--rungs", request.rungs, "tempering: temperatures")
      ->check(CLI::Range(2, 64))
      ->capture_default_str();
  command->add_option("--graph", request.device.graph.name, "emulator: its graph, as for gonogo qubo embed")
      ->type_name("GRAPH")
      ->capture_default_str();
  command->add_option("--dead-share", request.device.graph.dead_share, "emulator: share of dead qubits")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command->add_option("--dead-seed", request.device.graph.dead_seed, "emulator: seed of the dead qubits")
      ->check(kSeed)
      ->capture_default_str();
}

}  // namespace

void add_sample_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("sample", "Draw rows of variables and outcome from a model");
  auto options = std::make_shared<Options>();
  command->add_option("--model", options->model, "Model file, or name of one that ships")
      ->type_name(kModel)
      ->required();
  command->add_option("--out", options->out, "File of rows to write: .csv or .h5")->type_name(kFile)->required();
  command->add_option("--rows", options->request.rows, "Number of rows")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  command->add_option("--set", options->set, "Value of a variable, kept in every row; may be repeated")
      ->type_name(kSetting);
  command->add_option("--outcome", options->outcome, "Rows of this outcome only")->type_name("OUTCOME");
  command
      ->add_option("--from", options->from,
                   "machine: its joint distribution; prior: variables from the design's distribution, the outcome from "
                   "P(outcome | variables)")
      ->type_name(one_of({"machine", "prior"}))
      ->check(CLI::IsMember({"machine", "prior"}))
      ->capture_default_str();
  command
      ->add_option("--sampler", options->request.sampler,
                   "Of the machine. auto: exact where the rows can be summed, otherwise tempering")
      ->type_name(one_of(learn::row_samplers()))
      ->check(CLI::IsMember(learn::row_samplers()))
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
