// Training a machine of 48 visible and 20 hidden units through the emulated annealer, scored by exact log-likelihood of
// fresh rows as the share of what exact samples gain over independent units (docs/annealer.md).
//
//   learning_annealer [line ...] [seed=, chains=, sweeps=, gauges=, reads=, chain_coupling=, dead=]   all lines of the
//   table, or some; "thermometers": what each measures on one machine at several scales. Another seed is another
//   teacher, other rows, another device and another course of training.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "base/math/random.h"
#include "learning/annealer/annealer_sampler.h"
#include "learning/annealer/emulator.h"
#include "learning/rbm/train.h"
#include "learning/sampler/exact.h"
#include "tests/learning/gray_box.h"
#include "tests/learning/machine_likelihood.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

constexpr std::size_t kVisible = 48, kHidden = 20, kRows = 1000, kEpochs = 60, kBatch = 250;
constexpr double kFinalRate = 0.2;  // share of the rate at the last epoch

/// What the device is asked for; "name=value" on the command line.
struct DeviceUse {
  std::size_t chains = 100, sweeps = 600, gauges = 4, reads = 250;  // rows of an update, of a reading
  double chain_coupling = 0.6, dead = 0;                            // dead: share of the qubits
  std::uint64_t seed = 1;                                           // of everything that is drawn
};
DeviceUse use;

constexpr double kNominal = 0.2;  // temperature of the emulator in units of h: the scale that a naive user programs

VisibleLayout layout_of_bits() {
  std::vector<Encoder> encoders;
  for (std::size_t i = 0; i < kVisible; ++i)
    encoders.push_back(Encoder::by_range("bit" + std::to_string(i), "-", Code::thermometer, 2, 0, 1));
  return VisibleLayout(std::move(encoders), {});
}

/// Rows of a machine with normal weights, drawn exactly; draw: 0 for training, 1 for fresh ones.
std::vector<double> teacher_rows(std::uint64_t draw) {
  RbmWeights teacher = RbmWeights::zeros(kVisible, kHidden);
  for (std::size_t k = 0; k < teacher.weight.size(); ++k)
    teacher.weight[k] = std::sqrt(-2 * std::log(1 - random_unit(use.seed, 1, 2 * k))) *
                        std::cos(6.283185307179586 * random_unit(use.seed, 1, 2 * k + 1));
  for (std::size_t i = 0; i < kVisible; ++i)  // half the units on, in the mean
    for (std::size_t j = 0; j < kHidden; ++j) teacher.visible_bias[i] -= teacher.weight[i * kHidden + j] / 2;
  for (std::size_t i = 0; i < kVisible; ++i)
    for (std::size_t j = 0; j < kHidden; ++j) teacher.hidden_bias[j] -= teacher.weight[i * kHidden + j] / 2;
  const SampleSet samples = make_sampler("exact")->sample(to_qubo(teacher, layout_of_bits().unit_labels()),
                                                          {.reads = kRows, .seed = 2 * use.seed - 1 + draw});
  std::vector<double> rows;
  for (std::size_t r = 0; r < kRows; ++r)
    for (std::size_t i = 0; i < kVisible; ++i) rows.push_back(samples.row(r)[i]);
  return rows;
}

TrainingTable table_of(const std::vector<double>& rows) {
  TrainingTable table;
  table.variable_count = kVisible;
  for (double x : rows) table.variables.push_back(0.25 + 0.5 * x);
  table.outcome.assign(kRows, 0);
  table.weight.assign(kRows, 1.0);
  for (std::size_t n = 0; n < kRows; ++n) table.group.push_back(n);
  return table;
}

TrainingSettings training_settings() {
  TrainingSettings settings;
  settings.hidden = kHidden;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.weight_decay = 1;
  settings.batch = kBatch;
  settings.epochs = kEpochs;
  settings.report_every = 1;
  settings.learning_rate = 0.03;
  settings.final_learning_rate = kFinalRate;
  settings.centred = true;
  settings.chains = use.chains;
  settings.sweeps = 20;
  settings.seed = use.seed;
  return settings;
}

struct Line {
  const char* name;
  const char* thermometer;  // "" for lines without the annealer
  double scale;
};

RbmWeights trained_through_device(const Line& line, const TrainingTable& table, double& last_scale) {
  const Device device = d_wave_2x(use.dead, use.seed);
  AnnealerSettings annealer;
  annealer.scale = line.scale;
  annealer.sweeps = use.sweeps;
  annealer.chain_coupling = use.chain_coupling;
  annealer.gauges = use.gauges;
  AnnealerSampler sampler(std::make_shared<Emulator>(device), device.graph, kVisible, kHidden, annealer);
  TemperatureControl control(sampler, thermometer_named(line.thermometer), use.reads, use.sweeps, use.seed);
  const VisibleLayout layout = layout_of_bits();
  const auto labels = layout.unit_labels();
  const auto hook = [&](std::size_t epoch, const RbmWeights& weights) {
    control.update(epoch, to_qubo(weights, labels));
    return true;
  };
  TrainingSettings settings = training_settings();
  for (const auto& [visible, hidden] : sampler.embedding().uncoupled)
    settings.masked.emplace_back(visible, hidden - std::uint32_t(kVisible));
  if (use.dead > 0) std::printf("    %zu of %zu pairs masked\n", settings.masked.size(), kVisible * kHidden);
  const RbmWeights machine = train_rbm(layout, table, settings, sampler, hook).weights;
  last_scale = sampler.scale();
  for (const ThermometerReading& r : control.log())
    if (r.epoch % 10 == 0)
      std::printf("    epoch %zu: scale %.3f, beta %.3f [%.3f, %.3f]\n", r.epoch, r.scale, r.beta, r.low, r.high);
  return machine;
}

RbmWeights gray_box(const std::vector<double>& rows) {
  const Device device = d_wave_2x(0, use.seed);
  GrayBoxSettings settings;
  settings.reads = use.chains;
  settings.chain_coupling = use.chain_coupling;
  settings.gauges = use.gauges;
  settings.sweeps = use.sweeps;
  settings.seed = use.seed;
  GrayBox box(std::make_shared<Emulator>(device), device.graph, kVisible, kHidden, settings);
  std::uint64_t step = 0;
  for (std::size_t epoch = 1; epoch <= kEpochs; ++epoch) {
    const auto order = permutation(kRows, use.seed, epoch);
    for (std::size_t b = 0; b < kRows / kBatch; ++b, ++step) {
      std::vector<double> batch;
      for (std::size_t k = b * kBatch; k < (b + 1) * kBatch; ++k)
        batch.insert(batch.end(), rows.begin() + std::ptrdiff_t(order[k] * kVisible),
                     rows.begin() + std::ptrdiff_t((order[k] + 1) * kVisible));
      box.update(batch, 1 + (kFinalRate - 1) * double(epoch - 1) / double(kEpochs - 1));
    }
  }
  const BetaEstimate beta = box.measured_beta(2000);
  std::printf("    rows of the last machine: beta %.3f [%.3f, %.3f] of the programmed energies\n", beta.beta, beta.low,
              beta.high);
  return box.contracted(beta.beta);
}

/// The thermometers side by side on one trained machine: beta of rows at several scales by pseudo-likelihood, what the
/// histograms of two scales say, and what they would say if they measured the slope of the former.
void compare_thermometers(const TrainingTable& table) {
  const VisibleLayout layout = layout_of_bits();
  const Problem problem = to_qubo(train_rbm(layout, table, training_settings(), *make_sampler("block_gibbs")).weights,
                                  layout.unit_labels());
  const Device device = d_wave_2x(use.dead, use.seed);
  AnnealerSettings annealer;
  annealer.sweeps = use.sweeps;
  annealer.chain_coupling = use.chain_coupling;
  annealer.gauges = use.gauges;
  AnnealerSampler sampler(std::make_shared<Emulator>(device), device.graph, kVisible, kHidden, annealer);
  constexpr double kRatio = 0.75;
  std::vector<double> of_exact[2];  // energies of rows whose betas are 1 and kRatio without doubt
  for (const int k : {0, 1}) {
    const SampleSet rows = make_sampler("exact")->sample(scaled(problem, k == 0 ? 1 : kRatio),
                                                         {.reads = 2000, .seed = use.seed + std::uint64_t(k)});
    for (std::size_t r = 0; r < rows.row_count(); ++r) of_exact[k].push_back(energy(problem, rows.row(r)));
  }
  const BetaEstimate exact = histogram_beta(of_exact[0], 1, of_exact[1], kRatio);
  std::printf("exact rows of beta 1: by histograms %.3f [%.3f, %.3f]\n", exact.beta, exact.low, exact.high);
  std::fflush(stdout);
  for (const double scale : {0.1, 0.15, 0.2, 0.26, 0.35, 0.45}) {
    double beta[2], spread[2];
    std::vector<double> energies[2];
    for (const int k : {0, 1}) {
      sampler.set_scale(k == 0 ? scale : kRatio * scale);
      const SampleSet rows = sampler.sample(problem, {.reads = 2000, .seed = use.seed, .sweeps = use.sweeps});
      const BetaEstimate estimate = pseudo_likelihood_beta(problem, rows);
      beta[k] = estimate.beta;
      spread[k] = (estimate.high - estimate.low) / 4;
      energies[k] = rows.energies;
    }
    const BetaEstimate histogram = histogram_beta(energies[0], scale, energies[1], kRatio * scale);
    const double slope = (beta[0] - beta[1]) / (1 - kRatio), error = std::hypot(spread[0], spread[1]) / (1 - kRatio);
    std::printf(
        "scale %.3f: beta by pseudo-likelihood %.3f +- %.3f; by histograms %.3f [%.3f, %.3f]; slope of the first "
        "times the scale %.3f +- %.3f\n",
        scale, beta[0], spread[0], histogram.beta * scale, histogram.low * scale, histogram.high * scale, slope, error);
    std::fflush(stdout);
  }
}

RbmWeights independent_units(const std::vector<double>& rows) {
  RbmWeights machine = RbmWeights::zeros(kVisible, kHidden);
  machine.visible_bias = independent_bias(rows, kVisible);
  return machine;
}

/// Takes "name=value" off the arguments; true when it was one.
bool set_use(const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) return false;
  const std::string name = word.substr(0, equals);
  const double value = std::atof(word.c_str() + equals + 1);
  if (name == "seed") use.seed = std::uint64_t(value);
  if (name == "chains") use.chains = std::size_t(value);
  if (name == "sweeps") use.sweeps = std::size_t(value);
  if (name == "gauges") use.gauges = std::size_t(value);
  if (name == "reads") use.reads = std::size_t(value);
  if (name == "chain_coupling") use.chain_coupling = value;
  if (name == "dead") use.dead = value;
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> wanted;
  for (int k = 1; k < argc; ++k)
    if (!set_use(argv[k])) wanted.push_back(argv[k]);
  const std::vector<Line> lines = {{"independent", "", 0},
                                   {"exact", "", 0},
                                   {"block_gibbs", "", 0},
                                   {"pseudo_likelihood", "pseudo_likelihood", kNominal},
                                   {"histogram", "histogram", kNominal},
                                   {"offset_model", "offset_model", kNominal},
                                   {"nominal", "none", kNominal},
                                   {"unscaled", "none", 1},
                                   {"gray_box", "", 0}};
  const std::vector<double> rows = teacher_rows(0), fresh = teacher_rows(1);
  const TrainingTable table = table_of(rows);
  const double base = mean_log_likelihood(independent_units(rows), fresh);
  if (!wanted.empty() && wanted[0] == "thermometers") {
    compare_thermometers(table);
    return 0;
  }
  double exact = NAN;  // what exact samples reach, once that line has run
  for (const Line& line : lines) {
    const std::string name = line.name;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    double scale = 0;
    RbmWeights machine;
    if (name == "independent")
      machine = independent_units(rows);
    else if (name == "gray_box")
      machine = gray_box(rows);
    else if (*line.thermometer)
      machine = trained_through_device(line, table, scale);
    else
      machine = train_rbm(layout_of_bits(), table, training_settings(), *make_sampler(name)).weights;
    const double reached = mean_log_likelihood(machine, fresh);
    std::printf("%-20s %9.4f nat per fresh row, gain %8.4f", line.name, reached, reached - base);
    if (name == "exact") exact = reached;
    if (!std::isnan(exact)) std::printf(", share of exact samples %.3f", (reached - base) / (exact - base));
    if (scale > 0) std::printf(", last scale %.3f", scale);
    std::printf("\n");
    std::fflush(stdout);
  }
  return 0;
}
