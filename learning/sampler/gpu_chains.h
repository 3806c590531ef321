// Chains of block Gibbs sampling on a GPU, many at once. Draws have the random numbers of the CPU's chains (see
// ChainRandom), so that the rows depend on (seed, chain, sweep) alone and differ from the CPU's only where rounding
// decides: weights have 16 bits there (11 of precision), sums 24.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "learning/sampler/bipartite.h"

namespace gonogo::learning {

/// Whether this build can use GPUs and one is there.
bool gpu_answers();

class GpuChains {
 public:
  using Bit = std::uint8_t;

  /// Chains 0 .. chains - 1 of this seed. Throws InputError where no GPU answers, for a weight above 65,504 (the
  /// largest of 16 bits) and for a machine that does not fit the memory of one multiprocessor, naming the sizes.
  GpuChains(const Bipartite& machine, std::size_t chains, std::uint64_t seed);
  ~GpuChains();
  GpuChains(const GpuChains&) = delete;
  GpuChains& operator=(const GpuChains&) = delete;

  /// Independent fair bits, those of the CPU's chains.
  void scatter();
  /// [chain x (left + right)]
  void set_rows(const std::vector<Bit>& rows);
  std::vector<Bit> rows() const;

  /// Takes sweeps first + 1 .. first + count of all chains: the right side given the left, then the left given the
  /// right. Returns when they are done.
  void sweep(std::uint64_t first, std::uint64_t count);

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace gonogo::learning
