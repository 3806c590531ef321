#include "learning/machine/ladder.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "learning/sampler/chains/bipartite.h"

namespace gonogo::learning {
namespace {

double free_energy_of(const RbmWeights& machine, std::span<const Bit> bits) {
  return free_energy(machine, std::vector<double>(bits.begin(), bits.end()));
}

std::vector<double> transpose(const RbmWeights& machine) {
  std::vector<double> result(machine.weight.size());
  for (std::size_t i = 0; i < machine.visible_count; ++i)
    for (std::size_t j = 0; j < machine.hidden_count; ++j)
      result[j * machine.visible_count + i] = machine.weight[i * machine.hidden_count + j];
  return result;
}

}  // namespace

struct LadderChains::Tally {
  std::vector<double> proposed, accepted;  // [rungs - 1]
};

RbmWeights interpolated(const RbmWeights& machine, std::span<const double> base_bias, double beta) {
  RbmWeights result = machine;
  for (double& w : result.weight) w *= beta;
  for (double& b : result.hidden_bias) b *= beta;
  for (std::size_t i = 0; i < result.visible_count; ++i)
    result.visible_bias[i] = (1 - beta) * base_bias[i] + beta * machine.visible_bias[i];
  return result;
}

LadderChains::LadderChains(std::size_t chains, std::size_t visible_count, std::size_t hidden_count, std::uint64_t seed)
    : chains_(chains),
      visible_(visible_count),
      hidden_(hidden_count),
      seed_(seed),
      rows_(chains * kMaxRungs * visible_count) {
  for (std::size_t chain = 0; chain < chains_; ++chain) {
    ChainRandom random(seed_, chain, visible_ + hidden_ + 1);
    for (std::size_t rung = 0; rung < kMaxRungs; ++rung) {
      random.begin(rung);
      for (std::size_t i = 0; i < visible_; ++i)
        rows_[(chain * kMaxRungs + rung) * visible_ + i] = random(hidden_ + i) < 0.5;
    }
  }
}

void LadderChains::add_rung() {
  GONOGO_ASSERT(rungs_ < kMaxRungs);
  for (std::size_t chain = 0; chain < chains_; ++chain) {
    const auto from = rows_.begin() + std::ptrdiff_t((chain * kMaxRungs + rungs_ - 1) * visible_);
    std::copy(from, from + std::ptrdiff_t(visible_), from + std::ptrdiff_t(visible_));
  }
  ++rungs_;
}

void LadderChains::run_chain(std::span<const RbmWeights> ladder, std::span<const std::vector<double>> transposed,
                             std::size_t sweeps, std::size_t chain, Tally& tally) {
  ChainRandom random(seed_, chain, visible_ + hidden_ + 1);
  std::vector<double> hidden_field(hidden_), visible_field(visible_);
  std::vector<Bit> hidden(hidden_);
  const auto bits = [&](std::size_t rung) {
    return std::span(rows_).subspan((chain * kMaxRungs + rung) * visible_, visible_);
  };
  for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
    const std::uint64_t number = sweeps_done_ + sweep + 1;
    for (std::size_t r = 0; r < rungs_; ++r) {
      random.begin(number * kMaxRungs + r);
      side_field(bits(r), ladder[r].weight, ladder[r].hidden_bias, hidden_field);
      draw_bits(hidden_field, random, 0, hidden);
      side_field(hidden, transposed[r], ladder[r].visible_bias, visible_field);
      draw_bits(visible_field, random, hidden_, bits(r));
    }
    for (std::size_t r = number % 2; r + 1 < rungs_; r += 2) {  // odd and even pairs take turns
      const double gain = free_energy_of(ladder[r], bits(r)) + free_energy_of(ladder[r + 1], bits(r + 1)) -
                          free_energy_of(ladder[r], bits(r + 1)) - free_energy_of(ladder[r + 1], bits(r));
      random.begin(number * kMaxRungs + r);
      tally.proposed[r] += 1;
      if (random(visible_ + hidden_) >= std::exp(std::min(gain, 0.0))) continue;
      tally.accepted[r] += 1;
      std::swap_ranges(bits(r).begin(), bits(r).end(), bits(r + 1).begin());
    }
  }
}

void LadderChains::run(std::span<const RbmWeights> ladder, std::size_t sweeps) {
  if (ladder.size() > kMaxRungs) throw InputError("tempering: at most 64 rungs are possible");
  GONOGO_ASSERT(ladder.size() >= rungs_);
  while (rungs_ < ladder.size()) add_rung();
  std::vector<std::vector<double>> transposed;
  for (const RbmWeights& machine : ladder) transposed.push_back(transpose(machine));
  std::vector<Tally> tallies(chains_, {std::vector<double>(rungs_), std::vector<double>(rungs_)});
  for_each_on_host(chains_, 1,
                   [&](std::size_t chain) { run_chain(ladder, transposed, sweeps, chain, tallies[chain]); });
  sweeps_done_ += sweeps;
  acceptance_.assign(rungs_ - 1, 1.0);
  for (std::size_t r = 0; r + 1 < rungs_; ++r) {
    double proposed = 0, accepted = 0;
    for (const Tally& tally : tallies) {
      proposed += tally.proposed[r];
      accepted += tally.accepted[r];
    }
    if (proposed > 0) acceptance_[r] = accepted / proposed;
  }
}

}  // namespace gonogo::learning
