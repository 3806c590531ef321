// Samplers for problems with any couplings. All draws depend on (seed, chain, sweep) alone; rows are the same bits for
// any number of threads.
#pragma once
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

/// Simulated annealing, eight chains side by side: beta goes up linearly from beta_start to beta_end over the first
/// three quarters of the sweeps, by Metropolis' rule, and stays there for heat-bath sweeps. With beta_start = beta_end:
/// sampling at that beta. The rows follow exp(-beta_end E) as well as the last quarter equilibrates.
class Annealer final : public Sampler {
 public:
  explicit Annealer(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "anneal"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// Parallel tempering: replicas at inverse temperatures from beta_start to beta_end, geometrically spaced, exchanged
/// between neighbours after every sweep (Hukushima, Nemoto, J. Phys. Soc. Jpn. 65, 1604 (1996)). Every temperature has
/// two replicas, so that one run gives two reads; on sparse graphs these two also exchange a cluster of spins in which
/// they differ, which keeps the sum of their energies (Zhu, Ochoa, Katzgraber, arXiv:1501.05630). On dense graphs such
/// a cluster is everything, and the move is left out.
class Tempering final : public Sampler {
 public:
  explicit Tempering(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "tempering"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// Population annealing: beta from 0 to beta_end in equal steps; at each the population is resampled with weights
/// exp(-dbeta E) and swept (Hukushima, Iba, AIP Conf. Proc. 690, 200 (2003); Machta, arXiv:1006.3268). At least 1,000
/// members; info.log_z estimates log Z.
class PopulationAnnealing final : public Sampler {
 public:
  explicit PopulationAnnealing(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "population"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

}  // namespace gonogo::learning
