// Many chains of block Gibbs sampling on a GPU. Random numbers are those of the CPU's chains (ChainRandom), so that
// rows depend on (seed, chain, sweep) alone. They differ from the CPU's where rounding decides: weights have 11 bits of
// precision on the GPU, sums 24.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "learning/sampler/bipartite.h"

namespace gonogo::learning {

/// Whether this build can use GPUs and there is one.
bool gpu_answers();

class GpuChains {
 public:
  using Bit = std::uint8_t;

  /// Chains 0 .. chains - 1 of this seed. Throws InputError when no GPU answers, for weights above 65,504 (the largest
  /// of 16 bits), and for machines larger than the shared memory of a multiprocessor.
  GpuChains(const Bipartite& machine, std::size_t chains, std::uint64_t seed);
  ~GpuChains();
  GpuChains(const GpuChains&) = delete;
  GpuChains& operator=(const GpuChains&) = delete;

  /// Sets all rows to the fair bits with which the CPU's chains start.
  void scatter();
  /// [chain x (left + right)]
  void set_rows(const std::vector<Bit>& rows);
  std::vector<Bit> rows() const;

  /// Does sweeps first + 1 .. first + count of all chains: the right side given the left, then the left given the
  /// right. Returns when they are done.
  void sweep(std::uint64_t first, std::uint64_t count);

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace gonogo::learning
