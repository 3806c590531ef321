#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {
namespace {

std::shared_ptr<CapacityOptions> defaults() {
  auto options = std::make_shared<CapacityOptions>();
  options->request.bits = {4, 8};
  options->request.hidden = {4, 8, 16};
  options->request.connectivity = {"full", "sparse:0.3"};
  return options;
}

}  // namespace

void add_capacity_command(CLI::App& app, const Globals& globals, const Work<CapacityOptions>& work) {
  CLI::App* command = app.add_subcommand("capacity",
                                         "Which variables at how many bits, hidden units and couplers a dataset asks "
                                         "for: held-out likelihood against cost");
  const auto options = defaults();
  learn::CapacityRequest& request = options->request;
  command->add_option("--dataset", request.dataset, "Trials (dataset.h5)")->type_name(kFile)->required();
  command->add_option("--study", options->study, "Study whose sections \"learning\" and \"design\" apply")
      ->type_name(kStudy);
  command->add_option("--bits", request.bits, "Code lengths")
      ->delimiter(',')
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--hidden", request.hidden, "Hidden units")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command
      ->add_option(
          "--connectivity", request.connectivity,
          "full, sparse:<share of pairs>, or a hardware graph: chimera:12, or with dead qubits chimera:12,0.02")
      ->type_name("GRAPH")
      ->capture_default_str();
  command
      ->add_option("--variable-bits", request.variable_bits,
                   "Also one machine for each variable and each of these lengths of its code, 0: left out; the first "
                   "bits, hidden units and connectivity for all else")
      ->delimiter(',')
      ->check(CLI::Range(0, 64));
  command->add_option("--seed", request.seed, "Seed")->check(kSeed)->capture_default_str();
  command->add_option("--out", options->out, "CSV file to write")->type_name(kFile);
  add_examples(*command, {"gonogo capacity --dataset out/demo/dataset.h5 --bits 2,4,8 --hidden 2,8,32 \\\n"
                          "      --connectivity full sparse:0.3 chimera:12,0.02 --out capacity.csv",
                          "gonogo capacity --dataset out/demo/dataset.h5 --bits 4 --hidden 8 --connectivity full \\\n"
                          "      --variable-bits 0,2,8"});
  command->callback([options, work, &globals] { work(globals, *options); });
}

}  // namespace gonogo::app
