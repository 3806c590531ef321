#include "learning/sampler/word_chains.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kStarts = std::uint64_t(1) << 62;  // rows of random numbers that no sweep reaches

/// Work space of one chain.
struct Space {
  std::vector<double> field;  // [hidden]
  std::vector<double> score;  // [word]
};

void sweep(const WordMachine& machine, double beta, ChainRandom& random, std::span<std::uint16_t> words, Space& space) {
  const std::span<const double> bias = machine.hidden_bias(), word_bias = machine.word_bias();
  const std::vector<WordGroup>& groups = machine.groups();
  space.field.assign(bias.begin(), bias.end());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto add = machine.field(groups[g].first + words[g]);
    for (std::size_t j = 0; j < add.size(); ++j) space.field[j] += add[j];
  }
  space.score.assign(word_bias.begin(), word_bias.end());
  for (std::size_t j = 0; j < space.field.size(); ++j) {
    if (random(j) * (1 + std::exp(-beta * space.field[j])) >= 1) continue;  // unit j is off
    const auto add = machine.hidden_field(j);
    for (std::size_t w = 0; w < add.size(); ++w) space.score[w] += add[w];
  }
  for (double& x : space.score) x *= beta;
  for (std::size_t g = 0; g < groups.size(); ++g)
    words[g] = std::uint16_t(draw_word(std::span(space.score).subspan(groups[g].first, groups[g].length),
                                       random(machine.hidden_count() + g)));
}

}  // namespace

WordChains::WordChains(std::size_t chains, std::size_t rungs, std::uint64_t seed)
    : chains_(chains), rungs_(rungs), seed_(seed) {
  if (chains == 0) throw InputError("sampler: at least one chain is needed");
  if (rungs < 1 || rungs > kMaxRungs) throw InputError("sampler: rungs must lie between 1 and 64");
}

void WordChains::start(const WordMachine& machine) {
  groups_ = machine.groups().size();
  words_.resize(chains_ * rungs_ * groups_);
  for (std::size_t chain = 0; chain < chains_; ++chain) {
    ChainRandom random(seed_, chain, rungs_ * groups_);
    random.begin(kStarts);
    for (std::size_t rung = 0; rung < rungs_; ++rung)
      for (std::size_t g = 0; g < groups_; ++g)
        state(chain, rung)[g] = std::uint16_t(random(rung * groups_ + g) * double(machine.groups()[g].length));
  }
}

void WordChains::exchange(const WordMachine& machine, std::size_t chain, std::size_t rung, double u) {
  const auto here = state(chain, rung), above = state(chain, rung + 1);
  const double low = beta(rung), high = beta(rung + 1);
  const double gain = machine.log_weight(above, low) + machine.log_weight(here, high) - machine.log_weight(here, low) -
                      machine.log_weight(above, high);
  if (std::log(u) < gain) std::swap_ranges(here.begin(), here.end(), above.begin());
}

void WordChains::run_chain(const WordMachine& machine, std::size_t sweeps, std::size_t chain) {
  Space space;
  ChainRandom random(seed_, chain, machine.hidden_count() + groups_ + 1);
  for (std::size_t s = 0; s < sweeps; ++s) {
    const std::uint64_t number = sweeps_done_ + s;
    for (std::size_t rung = 0; rung < rungs_; ++rung) {
      random.begin(number * rungs_ + rung);
      sweep(machine, beta(rung), random, state(chain, rung), space);
    }
    for (std::size_t rung = std::size_t(number % 2); rung + 1 < rungs_; rung += 2) {
      random.begin(number * rungs_ + rung);
      exchange(machine, chain, rung, random(machine.hidden_count() + groups_));
    }
  }
}

void WordChains::run(const WordMachine& machine, std::size_t sweeps) {
  if (words_.empty()) start(machine);
  GONOGO_ASSERT(machine.groups().size() == groups_);
#pragma omp parallel for schedule(static)
  for (std::size_t chain = 0; chain < chains_; ++chain) run_chain(machine, sweeps, chain);
  sweeps_done_ += sweeps;
}

}  // namespace gonogo::learning
