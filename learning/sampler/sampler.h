// The sampling step: anything that can draw rows from P(x) proportional to exp(-E(x)). Training takes its negative
// phase from here and does not know which sampler it is.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

/// What only some samplers ask for.
struct SamplerSettings {
  bool on_gpu = false;                    // block_gibbs
  double beta_start = 0.1, beta_end = 1;  // anneal, tempering, population: rows follow exp(-beta_end E)
  std::size_t replicas = 10;              // tempering: temperatures
  std::size_t temperatures = 30;          // population: steps of beta
  std::filesystem::path folder;           // file: where problems and answers lie
  std::vector<std::string> command;       // command: program and arguments; {problem}, {answer}, {reads}, {seed}
  double time_limit_s = 600;              // command
};

class Sampler {
 public:
  virtual ~Sampler() = default;
  virtual std::string name() const = 0;
  /// One row for each read, in the order of chains; a pure function of problem and request. Throws InputError for a
  /// problem that this sampler cannot take.
  virtual SampleSet sample(const Problem& problem, const SampleRequest& request) const = 0;
};

/// "block_gibbs", "anneal", "tempering", "population", "exact", "file" or "command"; throws InputError naming them.
std::unique_ptr<Sampler> make_sampler(const std::string& name, const SamplerSettings& settings = {});

}  // namespace gonogo::learning
