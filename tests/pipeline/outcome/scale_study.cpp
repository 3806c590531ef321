// Training and evaluation on as many trials as a published data set has, with a known truth (docs/learning.md): P(go)
// falls over a steep edge in six of nine variables, which no logistic regression can follow.
//
//   learning_scale [trials=4000] [hold_out=1000, 0: no evaluation] [seed=1] [name=value ...]      settings of the
//   section "learning"
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/math/random.h"
#include "learning/score/score.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/evaluation/scores.h"
#include "pipeline/outcome/training/train_model.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;

namespace {

constexpr double kLower[] = {-20, -20, 12, 0, 0, 0, 0.3, 0.12, 0.8}, kUpper[] = {35, 20, 36, 15, 1, 1500, 1, 0.36, 3};

double true_p_go(const std::vector<double>& x) {
  const double limit = 0.8 * x[2] - 8 + 0.25 * x[3] + 12 * (x[6] - 0.65) - 0.02 * x[1] * x[1] + 4 * (x[4] - 0.5);
  return 1 / (1 + std::exp(0.8 * (x[0] - limit)));
}

std::vector<TrialRecord> trials(std::size_t count, std::uint64_t seed) {
  std::vector<TrialRecord> records;
  for (std::size_t n = 0; n < count; ++n) {
    TrialRecord record;
    record.point.index = record.point.seed = n;
    const bool replicate = n % 11 == 10;
    record.point.replicate_of = replicate ? std::int64_t(n - 1) : -1;
    for (std::size_t v = 0; v < contract().variables.size(); ++v)
      record.point.variables.push_back(kLower[v] +
                                       (kUpper[v] - kLower[v]) * random_unit(seed, replicate ? n - 1 : n, v));
    record.measures.assign(contract().measures.size(), 1.0);
    const auto& x = record.point.variables;
    const bool passes = random_unit(seed, n, 100) < true_p_go(x);
    record.verdict = !passes ? Verdict::no_go : random_unit(seed, n, 101) < 0.2 ? Verdict::slow_go : Verdict::go;
    record.reason = passes ? Reason::none : x[0] > 15 ? Reason::slid_back : Reason::traction;
    records.push_back(record);
  }
  return records;
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Brier score in expectation over what happens: of the truth itself where `predictor` is null.
double expected_brier(const std::vector<TrialRecord>& fresh, const Predictor* predictor) {
  double sum = 0;
  for (const TrialRecord& record : fresh) {
    const double p = true_p_go(record.point.variables), q = predictor ? predictor->p_go(record.point.variables) : p;
    sum += p * (1 - q) * (1 - q) + (1 - p) * q * q;
  }
  return sum / double(fresh.size());
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t count = 4000, hold_out = 1000;
  std::uint64_t seed = 1;
  std::string section;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k], name = word.substr(0, word.find('=')), value = word.substr(word.find('=') + 1);
    if (name == "trials")
      count = std::strtoul(value.c_str(), nullptr, 10);
    else if (name == "hold_out")
      hold_out = std::strtoul(value.c_str(), nullptr, 10);
    else if (name == "seed")
      seed = std::strtoul(value.c_str(), nullptr, 10);
    else
      section += (section.empty() ? "\"" : ", \"") + name + "\": " + value;
  }
  const TemporaryFolder folder;
  const std::filesystem::path dataset = folder.path() / "dataset.h5", model = folder.path() / "model.h5";
  write_dataset(dataset, {trials(count, seed), {}});
  const double start = seconds();
  const TrainingReport report = train_model({.dataset = dataset,
                                             .model = model,
                                             .seed = seed,
                                             .learning = Config::parse("{" + section + "}", "command line"),
                                             .design = {},
                                             .hold_out = hold_out});
  const double trained = seconds();
  if (hold_out > 0) {
    const Evaluation evaluation = evaluate_model(model, dataset);
    std::printf("%s%s%s", scores_text(evaluation.scores).c_str(), missing_text(evaluation.missing).c_str(),
                checks_text(evaluation.checks).c_str());
  }
  const double evaluated = seconds();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const Predictor predictor = Predictor::read(model);
  const auto fresh = trials(20000, seed + 1000);
  std::printf(
      "%zu trials, %zu held out: trained in %.1f s (%lld epochs), evaluated in %.1f s, %.0f MiB at most; expected "
      "Brier "
      "score on fresh points %.4f, of the truth %.4f; calibration error of folds %.4f, floor %.4f\n",
      count, hold_out, trained - start, static_cast<long long>(report.epochs), evaluated - trained,
      double(usage.ru_maxrss) / 1024, expected_brier(fresh, &predictor), expected_brier(fresh, nullptr),
      report.cross_validation.model().calibration_error, report.cross_validation.model().floor.calibration_mean);
  return 0;
}
