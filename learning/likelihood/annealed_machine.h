// Intermediate machines between independent units and a given machine (see likelihood.h), and one chain on them.
#pragma once
#include <span>
#include <vector>

#include "learning/encoding/encoder.h"
#include "learning/model/weights.h"
#include "learning/sampler/chain_random.h"

namespace gonogo::learning {

struct AnnealedMachine {
  AnnealedMachine(const RbmWeights& weights, std::span<const double> base_bias);
  double log_z_independent() const;  // log of the sum over v of f_0(v)

  RbmWeights machine;
  std::vector<double> weight_transpose;  // [hidden x visible]
  std::vector<double> base_bias;         // a0
};

/// A visible row and its hidden fields. Draws depend on (seed, chain, step) alone.
class AnnealedChain {
 public:
  AnnealedChain(const AnnealedMachine& machine, std::uint64_t seed, std::uint64_t chain);
  void start_independent();                        // v ~ f_0
  void start_at(std::span<const double> row);      // of {0, 1}
  double log_ratio(double from, double to) const;  // log f_to(v) - log f_from(v)
  void sweep(double beta, std::uint64_t step);     // step >= 1, each used once

 private:
  void refresh();
  const AnnealedMachine& machine_;
  ChainRandom random_;
  std::vector<Bit> visible_, hidden_;
  std::vector<double> field_, scaled_, visible_field_;  // field_: b + v'W
};

}  // namespace gonogo::learning
