// The sampling step: anything that can draw rows from P(x) proportional to exp(-E(x)). Training takes its negative
// phase from here and does not know which sampler it is.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

struct SampleRequest {
  std::size_t reads = 1;
  std::uint64_t seed = 0;
  /// Markov-chain samplers: sweeps over all variables before a chain is read.
  std::size_t sweeps = 1000;
  /// Markov-chain samplers: rows (as many as reads) to go on from, and the sweeps that led to them, so that a chain of
  /// 3 + 4 sweeps has the bits of one of 7. Samplers without chains ignore both.
  const SampleSet* start = nullptr;
  std::uint64_t first_sweep = 0;
};

class Sampler {
 public:
  virtual ~Sampler() = default;
  virtual std::string name() const = 0;
  /// One row for each read, in the order of chains; a pure function of problem and request. Throws InputError for a
  /// problem that this sampler cannot take.
  virtual SampleSet sample(const Problem& problem, const SampleRequest& request) const = 0;
};

/// "block_gibbs" or "exact"; throws InputError naming them.
std::unique_ptr<Sampler> make_sampler(const std::string& name);

}  // namespace gonogo::learning
