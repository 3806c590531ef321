// Joint distribution of models trained on the frozen quarter-wheel trials, and on a part of them whose inputs depend on
// each other (docs/learning.md).
//
//   learning_joint [dataset=data/quarter_wheel_32mm/dataset.h5] [seeds=32,33,...] [hold_out=1000] [thinned=0|1]
//                  [out=folder for models and the dataset] [name=value ...]      settings of the section "learning"
//
// `thinned` keeps a trial with probability max(0.35, 4 p (1 - p)), where p is P(go) of a neural network fitted to all
// trials. What is left crowds at the boundary, as the trials of an active design do.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "base/random.h"
#include "learning/rbm/network.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/evaluation/evaluate_model.h"
#include "pipeline/learn/evaluation/joint_scores.h"
#include "pipeline/learn/training/score_report.h"
#include "pipeline/learn/training/train_model.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::learn;

namespace {

std::vector<campaign::TrialRecord> thinned(const std::vector<campaign::TrialRecord>& records) {
  const TrainingData data = make_training_data(records, {});
  const std::vector<int> passable = passable_outcomes();
  std::vector<int> label;
  for (std::size_t y : data.table.outcome) label.push_back(passable[y]);
  const learning::NetworkModel network = learning::fit_network(data.table, label);
  std::vector<campaign::TrialRecord> kept;
  for (const campaign::TrialRecord& record : records) {
    const double p = network(record.point.variables);
    if (random_unit(5, 0, record.point.index) < std::max(0.35, 4 * p * (1 - p))) kept.push_back(record);
  }
  return kept;
}

struct Options {
  std::string dataset = "data/quarter_wheel_32mm/dataset.h5", section, out;
  std::vector<std::uint64_t> seeds = {32};
  std::size_t hold_out = 1000;
  bool thin = false;
};

Options read_options(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k], name = word.substr(0, word.find('=')), value = word.substr(word.find('=') + 1);
    if (name == "dataset") {
      options.dataset = value;
    } else if (name == "seeds") {
      options.seeds.clear();
      std::istringstream list(value);
      for (std::string seed; std::getline(list, seed, ',');)
        options.seeds.push_back(std::strtoull(seed.c_str(), nullptr, 10));
    } else if (name == "hold_out") {
      options.hold_out = std::strtoul(value.c_str(), nullptr, 10);
    } else if (name == "out") {
      options.out = value;
    } else if (name == "thinned") {
      options.thin = value == "1";
    } else {
      options.section += (options.section.empty() ? "\"" : ", \"") + name + "\": " + value;
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  const TemporaryFolder temporary;
  const std::filesystem::path folder = options.out.empty() ? temporary.path() : std::filesystem::path(options.out);
  std::filesystem::create_directories(folder);
  campaign::Dataset data = campaign::read_dataset(options.dataset);
  if (options.thin) data.records = thinned(data.records);
  campaign::write_dataset(folder / "dataset.h5", data);
  std::printf("%zu trials, %zu held out\n", data.records.size(), options.hold_out);
  for (const std::uint64_t seed : options.seeds) {
    const std::filesystem::path model = folder / ("model" + std::to_string(seed) + ".h5");
    const Json trained = train_model({.dataset = folder / "dataset.h5",
                                      .model = model,
                                      .seed = seed,
                                      .learning = Config::parse("{" + options.section + "}", "command line"),
                                      .design = {},
                                      .hold_out = options.hold_out});
    const Json report = evaluate_model(model, folder / "dataset.h5");
    std::printf("seed %llu, %lld epochs\n%s%s", static_cast<unsigned long long>(seed),
                static_cast<long long>(trained.at("epochs").integer()), scores_text(report.at("scores")).c_str(),
                joint_text(report.at("joint")).c_str());
    std::fflush(stdout);
  }
  return 0;
}
