// Divides groups of chains among blocks that run at the same time. The blocks' numbers of sweeps differ by at most one.
//
// The sweeps of all groups form a line, group after group. Every block takes an equal piece of the line (McNaughton,
// Management Science 6, 1 (1959)). Two blocks share a group on a border: the later block begins the group, as its first
// work, and the earlier block finishes it, as its last work. With at least as many groups as blocks, a piece is at
// least as long as one group. A group then has at most two stretches, and the first has ended before the second begins.
#pragma once
#include <cstdint>

#include "base/host_device.h"

namespace gonogo::learning {

/// Sweeps begin + 1 .. end of a group.
struct ChainStretch {
  std::uint64_t group = 0, begin = 0, end = 0;
};

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
