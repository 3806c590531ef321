#include "tests/learning/machine_likelihood.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/progress.h"
#include "learning/sampler/chains/bipartite.h"
#include "learning/sampler/exact.h"

namespace gonogo::learning {
namespace {

/// sum_j log(1 + exp(beta f_j)): one logarithm for every 8 units, whose product of at most (1 + e^80)^8 is finite.
double softplus_sum(std::span<const double> field, double beta) {
  double sum = 0;
  for (std::size_t begin = 0; begin < field.size(); begin += 8) {
    double product = 1;
    for (std::size_t j = begin; j < std::min(field.size(), begin + 8); ++j) {
      const double x = beta * field[j];
      if (x > 80)
        sum += x;
      else
        product *= 1 + std::exp(x);
    }
    sum += std::log(product);
  }
  return sum;
}

}  // namespace

AnnealedMachine::AnnealedMachine(const RbmWeights& weights, std::span<const double> base)
    : machine(weights), weight_transpose(weights.weight.size()), base_bias(base.begin(), base.end()) {
  if (base_bias.size() != machine.visible_count)
    throw InputError("annealed likelihood: the base machine has another number of units");
  for (std::size_t i = 0; i < machine.visible_count; ++i)
    for (std::size_t j = 0; j < machine.hidden_count; ++j)
      weight_transpose[j * machine.visible_count + i] = machine.weight[i * machine.hidden_count + j];
}

double AnnealedMachine::log_z_independent() const {
  double sum = double(machine.hidden_count) * std::numbers::ln2;
  for (double a : base_bias) sum += softplus(a);
  return sum;
}

AnnealedChain::AnnealedChain(const AnnealedMachine& machine, std::uint64_t seed, std::uint64_t chain)
    : machine_(machine),
      random_(seed, chain, machine.machine.visible_count + machine.machine.hidden_count),
      visible_(machine.machine.visible_count),
      hidden_(machine.machine.hidden_count),
      field_(hidden_.size()),
      scaled_(hidden_.size()),
      visible_field_(visible_.size()) {}

void AnnealedChain::refresh() { side_field(visible_, machine_.machine.weight, machine_.machine.hidden_bias, field_); }

void AnnealedChain::start_independent() {
  random_.begin(0);
  draw_bits(machine_.base_bias, random_, hidden_.size(), visible_);
  refresh();
}

void AnnealedChain::start_at(std::span<const double> row) {
  for (std::size_t i = 0; i < visible_.size(); ++i) visible_[i] = row[i] > 0.5;
  refresh();
}

double AnnealedChain::log_ratio(double from, double to) const {
  double bias = 0;
  for (std::size_t i = 0; i < visible_.size(); ++i)
    if (visible_[i]) bias += machine_.machine.visible_bias[i] - machine_.base_bias[i];
  return (to - from) * bias + softplus_sum(field_, to) - softplus_sum(field_, from);
}

void AnnealedChain::sweep(double beta, std::uint64_t step) {
  random_.begin(step);
  for (std::size_t j = 0; j < field_.size(); ++j) scaled_[j] = beta * field_[j];
  draw_bits(scaled_, random_, 0, hidden_);
  side_field(hidden_, machine_.weight_transpose, machine_.machine.visible_bias, visible_field_);
  for (std::size_t i = 0; i < visible_.size(); ++i)
    visible_field_[i] = (1 - beta) * machine_.base_bias[i] + beta * visible_field_[i];
  draw_bits(visible_field_, random_, hidden_.size(), visible_);
  refresh();
}

namespace {

/// Chains of RAISE have numbers from here on, those of AIS lie below.
constexpr std::uint64_t kRaiseChains = std::uint64_t(1) << 40;

double beta_of(std::size_t step, const AnnealingSettings& settings) { return double(step) / double(settings.steps); }

/// One walk up from independent units; returns log of its weight without log Z_0.
double walk_up(const AnnealedMachine& machine, const AnnealingSettings& settings, std::uint64_t chain) {
  AnnealedChain walker(machine, settings.seed, chain);
  walker.start_independent();
  double log_weight = 0;
  for (std::size_t k = 1; k <= settings.steps; ++k) {
    const double from = beta_of(k - 1, settings), to = beta_of(k, settings);
    log_weight += walker.log_ratio(from, to);
    if (k < settings.steps) walker.sweep(to, k);
  }
  return log_weight;
}

/// One walk down from a row; returns log of its weight without log f_1(v) - log Z_0.
double walk_down(const AnnealedMachine& machine, const AnnealingSettings& settings, std::span<const double> row,
                 std::uint64_t chain) {
  AnnealedChain walker(machine, settings.seed, chain);
  walker.start_at(row);
  double log_weight = 0;
  for (std::size_t k = settings.steps; k >= 1; --k) {
    const double from = beta_of(k, settings), to = beta_of(k - 1, settings);
    walker.sweep(from, k);
    log_weight += walker.log_ratio(from, to);
  }
  return log_weight;
}

void check_settings(const AnnealingSettings& settings) {
  if (settings.steps < 1 || settings.chains < 2 || settings.row_chains < 1)
    throw InputError("annealed likelihood: at least one step, two chains and one chain a row are needed");
}

}  // namespace

double mean_log_likelihood(const RbmWeights& weights, std::span<const double> rows) {
  const std::vector<std::string> labels = [&] {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < weights.visible_count; ++i) names.push_back("visible:" + std::to_string(i));
    return names;
  }();
  const std::size_t count = rows.size() / weights.visible_count;
  double sum = 0;
  for (std::size_t r = 0; r < count; ++r)
    sum -= free_energy(weights, rows.subspan(r * weights.visible_count, weights.visible_count));
  return sum / double(count) - exact_moments(to_qubo(weights, labels)).log_z;
}

LogZEstimate annealed_log_z(const RbmWeights& weights, std::span<const double> base_bias,
                            const AnnealingSettings& settings) {
  check_settings(settings);
  const AnnealedMachine machine(weights, base_bias);
  std::vector<double> log_weight(settings.chains);
#pragma omp parallel for schedule(static)
  for (std::size_t chain = 0; chain < settings.chains; ++chain)
    if (!cancel_requested()) log_weight[chain] = walk_up(machine, settings, chain);
  stop_if_cancelled();
  const double highest = *std::max_element(log_weight.begin(), log_weight.end()), n = double(settings.chains);
  double sum = 0, square = 0;
  for (double x : log_weight) {
    const double w = std::exp(x - highest);
    sum += w;
    square += w * w;
  }
  const double mean = sum / n, variance = std::max(0.0, square / n - mean * mean) * n / (n - 1);
  const double error = 3 * std::sqrt(variance / n), base = machine.log_z_independent() + highest;
  return {base + std::log(mean), mean > error ? base + std::log(mean - error) : -INFINITY,
          base + std::log(mean + error), sum * sum / square};
}

RaiseEstimate raise_log_likelihood(const RbmWeights& weights, std::span<const double> base_bias,
                                   std::span<const double> rows, const AnnealingSettings& settings) {
  check_settings(settings);
  const AnnealedMachine machine(weights, base_bias);
  const std::size_t width = weights.visible_count, count = rows.size() / width;
  if (count == 0) throw InputError("annealed likelihood: there are no rows");
  std::vector<double> value(count);
#pragma omp parallel for schedule(static)
  for (std::size_t r = 0; r < count; ++r) {
    if (cancel_requested()) continue;
    const auto row = rows.subspan(r * width, width);
    std::vector<double> walks;
    for (std::size_t k = 0; k < settings.row_chains; ++k)
      walks.push_back(walk_down(machine, settings, row, kRaiseChains + r * settings.row_chains + k));
    value[r] =
        log_sum_exp(walks) - std::log(double(walks.size())) - free_energy(weights, row) - machine.log_z_independent();
  }
  stop_if_cancelled();
  RaiseEstimate estimate;
  double square = 0;
  for (double x : value) estimate.mean += x / double(count);
  for (double x : value) square += (x - estimate.mean) * (x - estimate.mean);
  estimate.standard_error = count > 1 ? std::sqrt(square / double(count - 1) / double(count)) : INFINITY;
  return estimate;
}

std::vector<double> independent_bias(std::span<const double> rows, std::size_t visible_count) {
  const std::size_t row_count = rows.size() / visible_count;
  std::vector<double> bias(visible_count, 0.0);
  for (std::size_t k = 0; k < rows.size(); ++k) bias[k % visible_count] += rows[k];
  for (double& x : bias) x = std::log((x + 0.5) / (double(row_count) - x + 0.5));
  return bias;
}

LikelihoodBracket bracket_log_likelihood(const RbmWeights& weights, std::span<const double> rows,
                                         const AnnealingSettings& settings) {
  LikelihoodBracket bracket;
  if (std::min(weights.visible_count, weights.hidden_count) <= kMaxExact) {
    bracket.exact = true;
    bracket.mean = bracket.low = bracket.high = bracket.raise = mean_log_likelihood(weights, rows);
    return bracket;
  }
  const std::size_t width = weights.visible_count, count = rows.size() / width;
  const std::vector<double> base = independent_bias(rows, width);
  const LogZEstimate z = annealed_log_z(weights, base, settings);
  double energy = 0;
  for (std::size_t r = 0; r < count; ++r)
    energy += free_energy(weights, rows.subspan(r * width, width)) / double(count);
  const RaiseEstimate raise = raise_log_likelihood(weights, base, rows, settings);
  bracket.mean = -energy - z.log_z;
  bracket.low = -energy - z.high;
  bracket.high = -energy - z.low;
  bracket.raise = raise.mean;
  bracket.raise_error = raise.standard_error;
  bracket.effective_chains = z.effective_chains;
  return bracket;
}

}  // namespace gonogo::learning
