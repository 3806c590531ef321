#include "learning/likelihood/annealed_machine.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "learning/sampler/bipartite.h"

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

}  // namespace gonogo::learning
