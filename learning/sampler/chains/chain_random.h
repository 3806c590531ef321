// Random numbers of one Markov chain. Draw `unit` of row `row` depends on (seed, chain, row, unit) alone. A row is a
// sweep, or a sweep of a replica.
#pragma once
#include <cstdint>

#include "base/math/random.h"

namespace gonogo::learning {

class ChainRandom {
 public:
  ChainRandom(std::uint64_t seed, std::uint64_t chain, std::size_t units_per_row)
      : seed_(seed), chain_(chain), blocks_per_row_((units_per_row + 3) / 4) {}
  void begin(std::uint64_t row) {
    row_ = row * blocks_per_row_;
    held_ = UINT64_MAX;
  }
  /// Uniform in (0, 1) with 32 bits; end points excluded. unit < units_per_row.
  double operator()(std::size_t unit) {
    const std::uint64_t index = row_ + unit / 4;
    if (index != held_) {
      block_ = random_block(seed_, chain_, index);
      held_ = index;
    }
    return (double(block_.word[unit % 4]) + 0.5) * 0x1.0p-32;
  }

 private:
  std::uint64_t seed_, chain_, blocks_per_row_, row_ = 0, held_ = UINT64_MAX;
  RandomBlock block_{};
};

}  // namespace gonogo::learning
