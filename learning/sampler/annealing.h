// Samplers for problems with any couplings. Draws depend on (seed, chain, sweep) alone, so bits do not depend on
// threads.
#pragma once
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

/// Simulated annealing of eight chains at once. beta rises linearly from beta_start to beta_end over the first three
/// quarters of the sweeps, with Metropolis' rule. The last quarter is heat-bath sweeps at beta_end. Rows follow
/// exp(-beta_end E) as far as that quarter equilibrates.
class Annealer final : public Sampler {
 public:
  explicit Annealer(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "anneal"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// Parallel tempering over inverse temperatures from beta_start to beta_end in a geometric series. Neighbours exchange
/// states after every sweep (Hukushima, Nemoto, J. Phys. Soc. Jpn. 65, 1604 (1996)). Every temperature has two
/// replicas, so that a run gives two reads. On sparse graphs the two also exchange a cluster of spins in which they
/// differ, which keeps the sum of their energies (Zhu, Ochoa, Katzgraber, arXiv:1501.05630). On dense graphs a cluster
/// is the whole graph, and there is no such move.
class Tempering final : public Sampler {
 public:
  explicit Tempering(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "tempering"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// Population annealing from beta 0 to beta_end in equal steps. At each step the population is resampled with weights
/// exp(-dbeta E) and swept (Hukushima, Iba, AIP Conf. Proc. 690, 200 (2003); Machta, arXiv:1006.3268). The population
/// has at least 1,000 members. info.log_z estimates log Z.
class PopulationAnnealing final : public Sampler {
 public:
  explicit PopulationAnnealing(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "population"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

}  // namespace gonogo::learning
