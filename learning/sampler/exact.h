// Exact log Z, marginals and independent samples. Of a bipartite problem the smaller side is enumerated and the other
// summed in closed form. Other problems are enumerated as a whole. Large problems of low treewidth are summed variable
// by variable.
#pragma once
#include <cstdint>
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

inline constexpr std::size_t kMaxTableEntries = std::size_t(1) << 26;  // of all tables together: 512 MB

/// Exact answers for problems of low treewidth by bucket elimination (Dechter, Artificial Intelligence 113 (1999) 41).
/// Each eliminated variable has a table over itself and its remaining neighbours. Sampling goes back through the
/// tables; rows are independent draws.
class JunctionTree {
 public:
  /// Eliminates the variable with the fewest neighbours first. Throws InputError when the tables are too large.
  explicit JunctionTree(const Problem& problem);

  double log_z() const { return log_z_; }
  std::size_t width() const;  // max number of variables in a table, less one
  /// Spins +1 and -1 of one row.
  std::vector<std::int8_t> draw(std::uint64_t seed, std::uint64_t row) const;
  ExactMoments moments() const;

 private:
  struct Bucket {
    std::uint32_t variable;
    std::vector<std::uint32_t> rest;  // neighbours when eliminated, by order of elimination
    std::vector<double> log_weight;   // [2^(1 + rest)], bit 0: variable, bit k + 1: rest[k]
  };
  void order(const Problem& ising);
  void eliminate(const Problem& ising);

  Problem problem_;
  std::vector<Bucket> buckets_;
  std::vector<std::size_t> bucket_of_;  // [variable]
  double log_z_ = 0;
};

}  // namespace gonogo::learning
