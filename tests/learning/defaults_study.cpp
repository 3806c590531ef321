// The experiments behind the default settings (docs/learning.md): machines trained on 100 synthetic trials, scored
// against the true probabilities of 4000 fresh points, mean over several tables.
//
//   learning_defaults [tables = 6] [name=value ...]     one line for the given settings, or the whole study without any
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include "learning/rbm/regression/baselines.h"
#include "learning/rbm/train.h"
#include "learning/score/score.h"
#include "tests/learning/smooth_boundary.h"

using namespace gonogo::learning;

namespace {

struct Variant {
  TrainingSettings settings;
  std::size_t rows = 100, machines = 1;  // machines: average of so many seeds
};

using Setter = std::function<void(Variant&, double)>;

const std::map<std::string, Setter>& setters() {
  static const std::map<std::string, Setter> all = {
      {"hidden", [](Variant& v, double x) { v.settings.hidden = std::size_t(x); }},
      {"epochs", [](Variant& v, double x) { v.settings.epochs = std::size_t(x); }},
      {"batch", [](Variant& v, double x) { v.settings.batch = std::size_t(x); }},
      {"learning_rate", [](Variant& v, double x) { v.settings.learning_rate = x; }},
      {"generative", [](Variant& v, double x) { v.settings.generative = x; }},
      {"weight_decay", [](Variant& v, double x) { v.settings.weight_decay = x; }},
      {"initial_weight", [](Variant& v, double x) { v.settings.initial_weight = x; }},
      {"rows", [](Variant& v, double x) { v.rows = std::size_t(x); }},
      {"machines", [](Variant& v, double x) { v.machines = std::size_t(x); }}};
  return all;
}

using Forecaster = std::function<double(std::span<const double>)>;

/// Machines trained as gonogo train does: epochs by cross-validation, then all rows.
std::vector<RbmWeights> train(const Variant& variant, const TrainingTable& table, std::uint64_t seed) {
  const VisibleLayout layout = boundary_layout();
  const auto sampler = make_sampler("block_gibbs");
  TrainingSettings settings = variant.settings;
  settings.seed = seed;
  settings.epochs = cross_validate(layout, table, settings, *sampler, 5).best_epoch;
  std::vector<RbmWeights> machines;
  for (std::size_t m = 0; m < variant.machines; ++m) {
    settings.seed = seed + 1000 * m;
    machines.push_back(train_rbm(layout, table, settings, *sampler).weights);
  }
  return machines;
}

/// Mean of the machines' P(go); unknown variables summed out over the prior, over the machine's own joint distribution
/// where it is empty.
Forecaster answers(const std::vector<RbmWeights>& weights, const InputPrior& prior) {
  std::vector<Posterior> machines;
  for (const RbmWeights& machine : weights) machines.emplace_back(boundary_layout(), machine, prior);
  return [machines](std::span<const double> x) {
    double sum = 0;
    for (const Posterior& machine : machines) {
      const std::vector<double> p = machine.marginal(x).probability;
      sum += (p[0] + p[1]) / double(machines.size());
    }
    return sum;
  };
}

/// Brier score in expectation over what happens, with each two of the four variables that may matter hidden.
double two_hidden(const Forecaster& forecast, const TrainingTable& fresh, Boundary boundary) {
  double sum = 0, count = 0;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b)
      for (std::size_t n = 0; n < 500; ++n, ++count) {
        std::vector<double> x(fresh.row(n).begin(), fresh.row(n).end());
        const double p = true_p_go(x, boundary);
        x[a] = x[b] = NAN;
        const double q = forecast(x);
        sum += p * (1 - q) * (1 - q) + (1 - p) * q * q;
      }
  return sum / count;
}

/// The truth with unknown variables uniform on their ranges: mean over 400 draws.
Forecaster truth(Boundary boundary) {
  const TrainingTable draws = boundary_table(400, 7, boundary);
  return [draws, boundary](std::span<const double> x) {
    double sum = 0;
    for (std::size_t n = 0; n < draws.row_count(); ++n) {
      std::vector<double> filled(x.begin(), x.end());
      for (std::size_t v = 0; v < x.size(); ++v)
        if (std::isnan(x[v])) filled[v] = draws.row(n)[v];
      sum += true_p_go(filled, boundary) / double(draws.row_count());
    }
    return sum;
  };
}

/// Root mean square distance to the true probability.
double error_of(const Forecaster& forecast, const TrainingTable& fresh, Boundary boundary) {
  double sum = 0;
  for (std::size_t n = 0; n < fresh.row_count(); ++n) {
    const double d = forecast(fresh.row(n)) - true_p_go(fresh.row(n), boundary);
    sum += d * d;
  }
  return std::sqrt(sum / double(fresh.row_count()));
}

/// Largest sum of rises of P(go) along the slope, over 100 points: 0 when monotone.
double largest_rise(const Forecaster& forecast, const TrainingTable& fresh) {
  double worst = 0;
  for (std::size_t n = 0; n < 100; ++n) {
    std::vector<double> x(fresh.row(n).begin(), fresh.row(n).end());
    double last = 1, rise = 0;
    for (x[0] = 0; x[0] <= 35; x[0] += 0.5) {
      const double now = forecast(x);
      rise += std::max(0.0, now - last);
      last = now;
    }
    worst = std::max(worst, rise);
  }
  return worst;
}

std::vector<int> passable(const TrainingTable& table) {
  std::vector<int> go;
  for (std::size_t y : table.outcome) go.push_back(y < 2);
  return go;
}

double brier_of(const Forecaster& forecast, const TrainingTable& fresh) {
  std::vector<double> p;
  for (std::size_t n = 0; n < fresh.row_count(); ++n) p.push_back(forecast(fresh.row(n)));
  return brier_score(p, passable(fresh));
}

void report(const std::string& name, const Variant& variant, int tables) {
  for (Boundary boundary : {Boundary::straight, Boundary::curved}) {
    const TrainingTable fresh = boundary_table(4000, 999, boundary);
    double brier = 0, logistic_brier = 0, error = 0, logistic_error = 0, rise = 0;
    double hidden = 0, hidden_own = 0, hidden_logistic = 0;
    const auto start = std::chrono::steady_clock::now();
    for (int t = 0; t < tables; ++t) {
      const TrainingTable table = boundary_table(variant.rows, 100 + std::uint64_t(t), boundary);
      const std::vector<RbmWeights> machines = train(variant, table, std::uint64_t(t) + 1);
      const Forecaster machine = answers(machines, uniform_prior(boundary_layout()));
      const Forecaster logistic = fit_logistic(table, passable(table));
      brier += brier_of(machine, fresh) / tables;
      logistic_brier += brier_of(logistic, fresh) / tables;
      error += error_of(machine, fresh, boundary) / tables;
      logistic_error += error_of(logistic, fresh, boundary) / tables;
      rise += largest_rise(machine, fresh) / tables;
      hidden += two_hidden(machine, fresh, boundary) / tables;
      hidden_own += two_hidden(answers(machines, {}), fresh, boundary) / tables;
      hidden_logistic += two_hidden(logistic, fresh, boundary) / tables;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / tables;
    const double best = brier_of([&](auto x) { return true_p_go(x, boundary); }, fresh);
    std::printf("%-28s %-9s Brier %.4f (logistic %.4f, truth %.4f)  error %.4f (logistic %.4f)  rise %.4f  %.1f s\n",
                name.c_str(), boundary == Boundary::straight ? "straight" : "curved", brier, logistic_brier, best,
                error, logistic_error, rise, seconds);
    std::printf(
        "    two of four variables hidden: Brier %.4f, machine's own joint distribution %.4f, logistic at the mean "
        "%.4f, truth %.4f\n",
        hidden, hidden_own, hidden_logistic, two_hidden(truth(boundary), fresh, boundary));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int tables = argc > 1 ? std::atoi(argv[1]) : 6;
  Variant given;
  std::string name;
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i];
    const auto setter = setters().find(word.substr(0, word.find('=')));
    if (setter == setters().end()) {
      std::fprintf(stderr, "unknown setting %s\n", argv[i]);
      return 2;
    }
    setter->second(given, std::atof(word.c_str() + word.find('=') + 1));
    name += (name.empty() ? "" : " ") + word;
  }
  if (argc > 2) {
    report(name, given, tables);
    return 0;
  }
  report("defaults", {}, tables);
  const std::vector<std::pair<std::string, std::vector<double>>> study = {{"hidden", {4, 16, 32}},
                                                                          {"weight_decay", {0.1, 0.3, 3, 10}},
                                                                          {"generative", {0, 0.01, 0.2, 1}},
                                                                          {"learning_rate", {0.005, 0.05}},
                                                                          {"initial_weight", {0.02, 0.5}},
                                                                          {"machines", {4}},
                                                                          {"rows", {400, 1000}}};
  for (const auto& [setting, values] : study)
    for (double value : values) {
      Variant variant;
      setters().at(setting)(variant, value);
      report(setting + "=" + std::to_string(value).substr(0, 5), variant, tables);
    }
}
