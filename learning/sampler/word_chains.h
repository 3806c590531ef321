// Block Gibbs over the code words of a machine (word_machine.h). A sweep draws the hidden units given the words, then
// every group's word given the hidden units. With more than one rung, each chain has replicas at inverse temperatures
// 0 ... 1 that exchange their rows after every sweep (Hukushima, Nemoto, J. Phys. Soc. Japan 65:1604, 1996).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/sampler/chain_random.h"
#include "learning/sampler/word_machine.h"

namespace gonogo::learning {

class WordChains {
 public:
  static constexpr std::size_t kMaxRungs = 64;
  /// Throws InputError without a chain, and for rungs outside 1 .. kMaxRungs.
  WordChains(std::size_t chains, std::size_t rungs, std::uint64_t seed);

  /// Sweeps all chains. Machines of successive calls may have other weights, but the same groups. The first call starts
  /// from uniform words. Draws depend on (seed, chain, sweep) alone, so the bits do not depend on threads.
  void run(const WordMachine& machine, std::size_t sweeps);

  std::size_t chains() const { return chains_; }
  /// Row of a chain at inverse temperature 1: [group] index of the word inside its group.
  std::span<const std::uint16_t> row(std::size_t chain) const { return state(chain, rungs_ - 1); }

 private:
  std::span<const std::uint16_t> state(std::size_t chain, std::size_t rung) const {
    return std::span(words_).subspan((chain * rungs_ + rung) * groups_, groups_);
  }
  std::span<std::uint16_t> state(std::size_t chain, std::size_t rung) {
    return std::span(words_).subspan((chain * rungs_ + rung) * groups_, groups_);
  }
  double beta(std::size_t rung) const { return rungs_ > 1 ? double(rung) / double(rungs_ - 1) : 1.0; }
  void start(const WordMachine& machine);
  void run_chain(const WordMachine& machine, std::size_t sweeps, std::size_t chain);
  void exchange(const WordMachine& machine, std::size_t chain, std::size_t rung, double u);

  std::size_t chains_, rungs_, groups_ = 0;
  std::uint64_t seed_, sweeps_done_ = 0;
  std::vector<std::uint16_t> words_;  // [chain x rung x group]
};

}  // namespace gonogo::learning
