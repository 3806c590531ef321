// Block Gibbs sampling of bipartite problems: one sweep draws the right side given the left, then the left given the
// right. Random numbers depend on (seed, chain, sweep, unit) alone, so bits depend neither on threads nor on the other
// chains.
#pragma once
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

class BlockGibbs final : public Sampler {
 public:
  /// `on_gpu`: gpu_chains.h says how rows differ and which machines it rejects.
  explicit BlockGibbs(bool on_gpu = false) : on_gpu_(on_gpu) {}
  std::string name() const override { return "block_gibbs"; }
  /// Chains start from fair bits unless the request has rows. Throws InputError for a problem that is not bipartite.
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  bool on_gpu_;
};

}  // namespace gonogo::learning
