// Bit for bit, not nearly.
#pragma once
#include <cstring>
#include <vector>

#include "sim/scene/scene.h"

namespace gonogo::test {

inline bool same_bits(const std::vector<sim::BodyState>& a, const std::vector<sim::BodyState>& b) {
  static_assert(sizeof(sim::BodyState) == sizeof(Vec3d) + sizeof(Quat) + 2 * sizeof(Vec3), "no padding to compare");
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(sim::BodyState)) == 0;
}

/// NaNs are alike where their bits are.
inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

}  // namespace gonogo::test
