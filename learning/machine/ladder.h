// Parallel tempering on a ladder of machines of one size. Every chain has a visible row on each rung. Rows are swept by
// block Gibbs and exchanged between neighbouring rungs, so that the good mixing at the foot reaches the top. Rungs are
// temperatures (Hukushima, Nemoto 1996) or earlier states of a training run (Bereux, Decelle, Furtlehner, Rosset,
// Seoane, arXiv:2405.15376). Exchanges sum out the hidden units.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/encoding/encoder.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

/// (1 - beta) base + beta machine, where `base` has independent units.
RbmWeights interpolated(const RbmWeights& machine, std::span<const double> base_bias, double beta);

class LadderChains {
 public:
  static constexpr std::size_t kMaxRungs = 64;
  /// Chains start from fair bits. Draws depend on (seed, chain, sweep) alone.
  LadderChains(std::size_t chains, std::size_t visible_count, std::size_t hidden_count, std::uint64_t seed);

  /// Sweeps all rungs, with exchanges of neighbours after each sweep. ladder: rungs() machines, foot first.
  void run(std::span<const RbmWeights> ladder, std::size_t sweeps);
  /// Adds a top rung with copies of the old top's rows.
  void add_rung();
  std::size_t rungs() const { return rungs_; }
  std::size_t chains() const { return chains_; }
  std::span<const Bit> top(std::size_t chain) const { return row(chain, rungs_ - 1); }
  /// [rungs - 1] acceptance rate of exchanges in the last run; 1 without proposals.
  const std::vector<double>& acceptance() const { return acceptance_; }

 private:
  std::span<const Bit> row(std::size_t chain, std::size_t rung) const {
    return std::span(rows_).subspan((chain * kMaxRungs + rung) * visible_, visible_);
  }
  struct Tally;
  void run_chain(std::span<const RbmWeights> ladder, std::span<const std::vector<double>> transposed,
                 std::size_t sweeps, std::size_t chain, Tally& tally);

  std::size_t chains_, visible_, hidden_, rungs_ = 1;
  std::uint64_t seed_, sweeps_done_ = 0;
  std::vector<Bit> rows_;  // [chain x kMaxRungs x visible]
  std::vector<double> acceptance_;
};

}  // namespace gonogo::learning
