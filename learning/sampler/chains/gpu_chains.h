// Many chains of block Gibbs sampling on a GPU. Random numbers are those of the CPU's chains (ChainRandom), so that
// rows depend on (seed, chain, sweep) alone. They differ from the CPU's where rounding decides: weights have 11 bits of
// precision on the GPU, sums 24.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "base/host_device.h"
#include "learning/sampler/chains/bipartite.h"

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

/// Sweeps begin + 1 .. end of a group.
struct ChainStretch {
  std::uint64_t group = 0, begin = 0, end = 0;
};

/// Divides groups of chains among blocks that run at the same time. The blocks' numbers of sweeps differ by at most
/// one.
///
/// The sweeps of all groups form a line, group after group. Every block takes an equal piece of the line (McNaughton,
/// Management Science 6, 1 (1959)). Two blocks share a group on a border: the later block begins the group, as its
/// first work, and the earlier block finishes it, as its last work. With at least as many groups as blocks, a piece is
/// at least as long as one group. A group then has at most two stretches, and the first has ended before the second
/// begins.
class ChainShare {
 public:
  /// The share of `block` of `blocks` in `count` sweeps of each of `groups` groups; blocks <= groups, count > 0.
  GONOGO_HD ChainShare(std::uint64_t groups, std::uint64_t count, int block, int blocks)
      : count_(count),
        position_(border(groups * count, block, blocks)),
        end_(border(groups * count, block + 1, blocks)) {}

  GONOGO_HD bool done() const { return position_ >= end_; }

  /// The next stretch. On the line a group's last sweep comes first: what the piece begins with are then the first
  /// sweeps of their group, and what it ends with the last ones.
  GONOGO_HD ChainStretch next() {
    const std::uint64_t group = position_ / count_, start = position_ % count_;
    const std::uint64_t rest = end_ - position_, stop = rest < count_ - start ? start + rest : count_;
    position_ += stop - start;
    return {group, count_ - stop, count_ - start};
  }

 private:
  /// line * block / blocks, without overflow of 64 bits.
  GONOGO_HD static std::uint64_t border(std::uint64_t line, int block, int blocks) {
    const std::uint64_t b = std::uint64_t(block), n = std::uint64_t(blocks);
    return line / n * b + line % n * b / n;
  }

  std::uint64_t count_, position_, end_;
};

}  // namespace gonogo::learning
