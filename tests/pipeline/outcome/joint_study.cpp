// Joint distribution of models trained on the frozen quarter-wheel trials, and on a part of them whose inputs depend on
// each other (docs/learning.md).
//
//   learning_joint [dataset=data/quarter_wheel_32mm/dataset.h5] [seeds=32,33,...] [hold_out=1000] [thinned=0|1]
//                  [active=0|trials] [out=folder for models and the dataset] [name=value ...]      settings of the
//                  section "learning"
//
//   learning_joint model=FILE [rows=FILE] [dataset=...]      scores a model, and rows, that are there
//
// `thinned` keeps a trial with probability max(0.35, 4 p (1 - p)), where p is P(go) of a neural network fitted to all
// trials. What is left crowds at the boundary, as the trials of an active design do.
//
// `active` makes so many trials of an active design instead, on a study whose boundary is known: 64 of a Sobol'
// sequence, then batches of 64 that choose_batch() draws by the P(go) of a Gaussian process fitted to those before.
// Its scores are the model's own and the joint distribution's.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "base/math/random.h"
#include "learning/rbm/regression/baselines.h"
#include "learning/rbm/regression/gaussian_process.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/active/choose.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/evaluation/joint_scores.h"
#include "pipeline/outcome/evaluation/scores.h"
#include "pipeline/outcome/training/train_model.h"
#include "tests/pipeline/outcome/known_boundary.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::outcome;

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

std::vector<campaign::TrialRecord> active_trials(std::size_t count) {
  constexpr std::uint64_t kBatch = 64, kCandidates = 128;  // candidates for each point
  const campaign::DesignSpec spec = known_boundary_box(1, kBatch);
  std::vector<campaign::TrialRecord> records;
  const auto run = [&](std::vector<campaign::DesignPoint> points) {
    for (campaign::DesignPoint& point : points)
      records.push_back(known_boundary_trial(spec, std::move(point), records.size()));
  };
  run(campaign::make_design(spec));
  while (records.size() < count) {
    const learning::TrainingTable table = make_training_data(records, {}).table;
    std::vector<int> label;
    for (const campaign::TrialRecord& record : records) label.push_back(record.verdict == campaign::Verdict::go);
    const learning::GaussianProcessModel process = learning::fit_gaussian_process(table, label);
    const ModelAnswers answers{.p_go =
                                   [&](std::span<const double> points, std::span<double> p) {
                                     const std::vector<double> found = process.probabilities(points);
                                     std::copy(found.begin(), found.end(), p.begin());
                                   },
                               .novelty = [](std::span<const double>) { return 0.0; }};
    run(choose_batch(spec, answers,
                     {.count = std::min<std::uint64_t>(kBatch, count - records.size()),
                      .skip = kCandidates * records.size(),
                      .candidates = kCandidates * kBatch}));
  }
  return records;
}

struct Options {
  std::string dataset = "data/quarter_wheel_32mm/dataset.h5", section, out, model, rows;
  std::vector<std::uint64_t> seeds = {32};
  std::size_t hold_out = 1000, active = 0;  // active: trials; 0: those of the dataset
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
    } else if (name == "active") {
      options.active = std::strtoul(value.c_str(), nullptr, 10);
    } else if (name == "model") {
      options.model = value;
    } else if (name == "rows") {
      options.rows = value;
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

void print_joint(const Evaluation& evaluation) {
  const learning::ForecastScores& model = evaluation.scores.model();
  std::printf("%zu held out; the model's Brier score %.4f [%.4f, %.4f], calibration error %.4f\n%s", evaluation.trials,
              model.brier.value, model.brier.low, model.brier.high, model.calibration_error,
              joint_text(evaluation.joint).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  if (!options.model.empty()) {
    print_joint(evaluate_joint(options.model, options.dataset, options.rows));
    return 0;
  }
  const TemporaryFolder temporary;
  const std::filesystem::path folder = options.out.empty() ? temporary.path() : std::filesystem::path(options.out);
  std::filesystem::create_directories(folder);
  campaign::Dataset data;
  if (options.active > 0)
    data.records = active_trials(options.active);
  else
    data = campaign::read_dataset(options.dataset);
  if (options.thin) data.records = thinned(data.records);
  campaign::write_dataset(folder / "dataset.h5", data);
  std::printf("%zu trials, %zu held out\n", data.records.size(), options.hold_out);
  for (const std::uint64_t seed : options.seeds) {
    const std::filesystem::path model = folder / ("model" + std::to_string(seed) + ".h5");
    const TrainingReport trained = train_model({.dataset = folder / "dataset.h5",
                                                .model = model,
                                                .seed = seed,
                                                .learning = Config::parse("{" + options.section + "}", "command line"),
                                                .design = {},
                                                .hold_out = options.hold_out});
    std::printf("seed %llu, %zu epochs\n", static_cast<unsigned long long>(seed), trained.epochs);
    if (options.active > 0) {
      print_joint(evaluate_joint(model, folder / "dataset.h5"));
    } else {
      const Evaluation evaluation = evaluate_model(model, folder / "dataset.h5");
      std::printf("%s%s", scores_text(evaluation.scores).c_str(), joint_text(evaluation.joint).c_str());
    }
    std::fflush(stdout);
  }
  return 0;
}
