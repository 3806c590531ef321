// Exact log Z, marginals and independent samples. Of a bipartite problem the smaller side is enumerated and the other
// summed in closed form. Other problems are enumerated as a whole. Large problems of low treewidth are summed variable
// by variable (junction_tree.h).
#pragma once
#include <vector>

#include "learning/sampler/sampler.h"

namespace gonogo::learning {

inline constexpr std::size_t kMaxEnumerated = 22;  // variables; 4 million states, 32 MB

struct ExactMoments {
  double log_z = 0;               // log of sum over x of exp(-E(x))
  std::vector<double> mean;       // [variable_count]: E[x_i] in the problem's vartype
  std::vector<double> pair_mean;  // [coupling count]: E[x_a x_b], in the order of the couplings
};

/// By enumeration up to kMaxEnumerated variables, otherwise by a junction tree. Throws InputError when the problem is
/// too large for both.
ExactMoments exact_moments(const Problem& problem);

class ExactSampler final : public Sampler {
 public:
  std::string name() const override { return "exact"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;
};

}  // namespace gonogo::learning
