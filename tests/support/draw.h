// Seeded draws for random cases.
#pragma once
#include <cmath>

#include "base/math/random.h"
#include "base/math/vec.h"
#include "base/units.h"

namespace gonogo::test {

/// Draws in sequence from one seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  double unit() { return random_unit(seed_, 0, index_++); }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// Uniform in the logarithm.
  double magnitude(double low, double high) { return low * std::pow(high / low, unit()); }
  int below(int count) { return int(unit() * count); }
  Vec3d in_box(const Vec3d& low, const Vec3d& high) {
    const double x = between(low.x, high.x), y = between(low.y, high.y), z = between(low.z, high.z);
    return {x, y, z};
  }
  /// Uniform on the unit sphere.
  Vec3d direction() {
    const double z = between(-1, 1), angle = between(0, 2 * kPi), ring = std::sqrt(1 - z * z);
    return {ring * std::cos(angle), ring * std::sin(angle), z};
  }
  Quat orientation() {
    const Vec3d axis = direction();
    const double half = between(0, kPi) / 2;
    return {Real(std::cos(half)), Real(axis.x * std::sin(half)), Real(axis.y * std::sin(half)),
            Real(axis.z * std::sin(half))};
  }

 private:
  std::uint64_t seed_, index_ = 0;
};

}  // namespace gonogo::test
