// Normally distributed numbers, value = f(seed, stream, index), from base/random.h.
#pragma once
#include <cmath>
#include <cstdint>

#include "base/random.h"
#include "base/units.h"

namespace gonogo {

/// Mean 0, variance 1 / precision (Box and Muller, Ann. Math. Statist. 29:610, 1958). Uses the uniform numbers
/// 2 index and 2 index + 1 of the stream.
inline double random_normal(std::uint64_t seed, std::uint64_t stream, std::uint64_t index, double precision = 1) {
  const double u = 1 - random_unit(seed, stream, 2 * index), v = random_unit(seed, stream, 2 * index + 1);
  return std::sqrt(-2 * std::log(u) / precision) * std::cos(2 * kPi * v);
}

}  // namespace gonogo
