#include <memory>

#include "base/files/file.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/outcome/training/capacity.h"

namespace gonogo::app {
namespace {

struct CapacityOptions {
  std::filesystem::path study, out;  // empty: defaults, no file
  outcome::CapacityRequest request;  // without its sections
};

void find_capacity(const Globals& globals, const CapacityOptions& options) {
  outcome::CapacityRequest request = options.request;
  if (!options.study.empty()) {
    const campaign::Study study = campaign::read_study(options.study);
    request.learning = study.config.object_if("learning");
    request.design = study.config.object_if("design");
  }
  const outcome::Capacity capacity = outcome::measure_capacity(request);
  if (!options.out.empty()) write_file_atomically(options.out, outcome::capacity_csv(capacity));
  print_result(globals, outcome::to_json(capacity), outcome::capacity_text(capacity));
}

std::shared_ptr<CapacityOptions> defaults() {
  auto options = std::make_shared<CapacityOptions>();
  options->request.bits = {4, 8};
  options->request.hidden = {4, 8, 16};
  options->request.connectivity = {"full", "sparse:0.3"};
  return options;
}

}  // namespace

void add_capacity_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("capacity",
                                         "Which variables at how many bits, hidden units and couplers a dataset asks "
                                         "for: held-out likelihood against cost");
  const auto options = defaults();
  outcome::CapacityRequest& request = options->request;
  add_named(*command, "--dataset", request.dataset, kFile, "Trials (dataset.h5)")->required();
  add_named(*command, "--study", options->study, kStudy, "Study whose sections \"learning\" and \"design\" apply");
  command->add_option("--bits", request.bits, "Code lengths")
      ->delimiter(',')
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--hidden", request.hidden, "Hidden units")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  add_named(*command, "--connectivity", request.connectivity, "GRAPH",
            "full, sparse:<share of pairs>, or a hardware graph: chimera:12, or with dead qubits chimera:12,0.02")
      ->capture_default_str();
  command
      ->add_option("--variable-bits", request.variable_bits,
                   "Also one machine for each variable and each of these lengths of its code, 0: left out; the first "
                   "bits, hidden units and connectivity for all else")
      ->delimiter(',')
      ->check(CLI::Range(0, 64));
  command->add_option("--seed", request.seed, "Seed")->check(kSeed)->capture_default_str();
  add_named(*command, "--out", options->out, kFile, "CSV file to write");
  add_examples(*command, {"gonogo capacity --dataset out/demo/dataset.h5 --bits 2,4,8 --hidden 2,8,32 \\\n"
                          "      --connectivity full sparse:0.3 chimera:12,0.02 --out capacity.csv",
                          "gonogo capacity --dataset out/demo/dataset.h5 --bits 4 --hidden 8 --connectivity full \\\n"
                          "      --variable-bits 0,2,8"});
  calls<find_capacity>(*command, globals, options);
}

}  // namespace gonogo::app
