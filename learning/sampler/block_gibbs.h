// Block Gibbs sampling of bipartite problems: one sweep draws the right side given the left, then the left given the
// right. Random numbers depend on (seed, chain, sweep, unit) alone, so the rows are the same bits for any number of
// threads and for any batch a chain is part of.
#pragma once
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

class BlockGibbs final : public Sampler {
 public:
  /// `on_gpu`: see gpu_chains.h for how its rows differ, and for what it refuses.
  explicit BlockGibbs(bool on_gpu = false) : on_gpu_(on_gpu) {}
  std::string name() const override { return "block_gibbs"; }
  /// Chains start from independent fair bits unless the request gives rows. Throws InputError for a problem that is not
  /// bipartite.
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  bool on_gpu_;
};

}  // namespace gonogo::learning
