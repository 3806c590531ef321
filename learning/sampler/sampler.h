// Interface of samplers, which draw rows from P(x) proportional to exp(-E(x)). Training takes its negative phase from
// any of them.
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
  /// Of Markov-chain samplers: sweeps before a chain is read.
  std::size_t sweeps = 1000;
  /// Of Markov-chain samplers: `reads` rows to continue from, and the number of sweeps behind them. A chain of 3 + 4
  /// sweeps then has the bits of a chain of 7. Samplers without chains ignore both.
  const SampleSet* start = nullptr;
  std::uint64_t first_sweep = 0;
};

/// Settings of particular samplers.
struct SamplerSettings {
  bool on_gpu = false;                    // block_gibbs
  double beta_start = 0.1, beta_end = 1;  // anneal, tempering, population; rows follow exp(-beta_end E)
  std::size_t replicas = 10;              // tempering: number of temperatures
  std::size_t temperatures = 30;          // population: number of steps of beta
  std::filesystem::path folder;           // file: folder of problems and answers
  std::vector<std::string> command;       // command: program and arguments; {problem}, {answer}, {reads}, {seed}
  double time_limit_s = 600;              // command
};

class Sampler {
 public:
  virtual ~Sampler() = default;
  virtual std::string name() const = 0;
  /// One row per read, in the order of chains. A pure function of problem and request. Throws InputError for problems
  /// that this sampler does not support.
  virtual SampleSet sample(const Problem& problem, const SampleRequest& request) const = 0;
};

/// "block_gibbs", "anneal", "tempering", "population", "exact", "file" or "command". Throws InputError that lists them.
std::unique_ptr<Sampler> make_sampler(const std::string& name, const SamplerSettings& settings = {});

}  // namespace gonogo::learning
