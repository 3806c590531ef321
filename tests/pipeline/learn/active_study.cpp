// Active design against Sobol' with the model that `gonogo campaign active` trains, on a study whose boundary is known
// (docs/campaigns.md). test_pipeline_active asks the same of a Gaussian process, which takes seconds.
//
//   learning_active [repeats=5] [active=128] [name=value ...]      settings of the section "learning"
//
// An active design of so many trials against Sobol' designs of as many and of twice as many.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/active/choose.h"
#include "pipeline/learn/answer/predictor.h"
#include "pipeline/learn/training/train_model.h"
#include "tests/pipeline/learn/known_boundary.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::learn;

namespace {

constexpr std::uint64_t kSeeds = 64, kBatch = 32;

class Study {
 public:
  explicit Study(std::string section) : section_(std::move(section)) {}

  Predictor train(const DesignSpec& spec, const std::vector<DesignPoint>& points) const {
    std::vector<TrialRecord> records;
    for (const DesignPoint& point : points) records.push_back(known_boundary_trial(spec, point, records.size()));
    const std::filesystem::path dataset = folder_.path() / "dataset.h5", model = folder_.path() / "model.h5";
    write_dataset(dataset, {records, {}});
    std::string ranges;
    for (const SampledVariable& r : spec.ranges)
      ranges += (ranges.empty() ? "\"" : ", \"") + contract().variables[r.variable].name + "\": [" +
                std::to_string(r.minimum) + ", " + std::to_string(r.maximum) + "]";
    train_model({.dataset = dataset,
                 .model = model,
                 .seed = spec.seed,
                 .learning = Config::parse("{" + section_ + "}", "command line"),
                 .design = Config::parse("{\"ranges\": {" + ranges + "}}", "design")});
    return Predictor::read(model);
  }

 private:
  std::string section_;
  TemporaryFolder folder_;
};

double brier(const DesignSpec& spec, const Predictor& model) {
  return known_boundary_brier(spec, [&](const std::vector<double>& x) { return model.p_go(x); });
}

/// Trials -> Brier score, after the seeds and after each batch, as run_active chooses them.
std::map<std::uint64_t, double> active_scores(const Study& study, std::uint64_t seed, std::uint64_t most) {
  const DesignSpec spec = known_boundary_box(seed, kSeeds);
  std::vector<DesignPoint> points = make_design(spec);
  std::map<std::uint64_t, double> scores;
  for (;;) {
    const Predictor model = study.train(spec, points);
    scores[points.size()] = brier(spec, model);
    if (points.size() >= most) return scores;
    const ModelAnswers answers{.p_go = [&](std::span<const double> x, std::span<double> p) { model.p_go(x, p); },
                               .novelty = [&](std::span<const double> x) { return model.novelty(x); }};
    for (DesignPoint& point :
         choose_batch(spec, answers, {.count = kBatch, .skip = 128 * points.size(), .candidates = 128 * kBatch}))
      points.push_back(std::move(point));
  }
}

struct Spread {
  double sum = 0, squares = 0, count = 0;
  void add(double x) { sum += x, squares += x * x, ++count; }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean())); }
};

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t repeats = 5, most = 128;
  std::string section;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k], name = word.substr(0, word.find('=')), value = word.substr(word.find('=') + 1);
    if (name == "repeats")
      repeats = std::strtoul(value.c_str(), nullptr, 10);
    else if (name == "active")
      most = std::strtoul(value.c_str(), nullptr, 10);
    else
      section += (section.empty() ? "\"" : ", \"") + name + "\": " + value;
  }
  const Study study(section);
  std::map<std::uint64_t, Spread> active, sobol;
  for (std::uint64_t seed = 1; seed <= repeats; ++seed) {
    std::printf("repeat %d:", int(seed));
    const auto add = [](const char* design, std::uint64_t trials, double score, Spread& spread) {
      spread.add(score);
      std::printf(" %s %d %.5f", design, int(trials), score);
      std::fflush(stdout);
    };
    for (const auto& [trials, score] : active_scores(study, seed, most)) add("active", trials, score, active[trials]);
    for (std::uint64_t trials : {most, 2 * most}) {
      const DesignSpec spec = known_boundary_box(seed, trials);
      add("Sobol'", trials, brier(spec, study.train(spec, make_design(spec))), sobol[trials]);
    }
    std::printf("\n");
  }
  for (const auto& [name, scores] : {std::pair("active", active), std::pair("Sobol'", sobol)})
    for (const auto& [trials, score] : scores)
      std::printf("%s %3d trials: Brier score %.5f +- %.5f\n", name, int(trials), score.mean(), score.deviation());
  return 0;
}
