#include <filesystem>
#include <memory>
#include <string>

#include "base/file.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/learn/training/capacity.h"

namespace gonogo::app {
namespace {

struct Options {
  std::string dataset, study, out;
  learn::CapacityRequest request{.dataset = {},
                                 .learning = {},
                                 .design = {},
                                 .seed = 1,
                                 .bits = {4, 8},
                                 .hidden = {4, 8, 16},
                                 .connectivity = {"full", "sparse:0.3"},
                                 .variable_bits = {}};
};

}  // namespace

void add_capacity_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("capacity",
                                         "Which variables at how many bits, hidden units and couplers a dataset asks "
                                         "for: held-out likelihood against cost");
  auto options = std::make_shared<Options>();
  learn::CapacityRequest& request = options->request;
  command->add_option("--dataset", options->dataset, "Trials (dataset.h5)")->required();
  command->add_option("--study", options->study, "Study whose sections \"learning\" and \"design\" apply");
  command->add_option("--bits", request.bits, "Code lengths")->delimiter(',')->check(CLI::Range(1, 64));
  command->add_option("--hidden", request.hidden, "Hidden units")->delimiter(',')->check(CLI::Range(1, 1024));
  command->add_option(
      "--connectivity", request.connectivity,
      "full, sparse:<share of pairs>, or a hardware graph: chimera:12, or with dead qubits chimera:12,0.02");
  command
      ->add_option("--variable-bits", request.variable_bits,
                   "Also one machine for each variable and each of these lengths of its code, 0: left out; the first "
                   "bits, hidden units and connectivity for all else")
      ->delimiter(',')
      ->check(CLI::Range(0, 64));
  command->add_option("--seed", request.seed, "Seed")->capture_default_str();
  command->add_option("--out", options->out, "CSV file to write");
  command->footer(
      "Example:\n  gonogo capacity --dataset out/demo/dataset.h5 --bits 2,4,8 --hidden 2,8,32 --connectivity full "
      "sparse:0.3 chimera:12,0.02 --out capacity.csv\n"
      "  gonogo capacity --dataset out/demo/dataset.h5 --bits 4 --hidden 8 --connectivity full --variable-bits 0,2,8");
  command->callback([options, &globals] {
    learn::CapacityRequest asked = options->request;
    asked.dataset = options->dataset;
    if (!options->study.empty()) {
      const campaign::Study study = campaign::read_study(options->study);
      asked.learning = study.config.object_if("learning");
      asked.design = study.config.object_if("design");
    }
    const Json report = learn::measure_capacity(asked);
    if (!options->out.empty()) write_file_atomically(options->out, learn::capacity_csv(report));
    print_result(globals, report, learn::capacity_text(report));
  });
}

}  // namespace gonogo::app
