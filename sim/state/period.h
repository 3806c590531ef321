// Periodic axes: positions folded into the period, and differences between nearest images. Period 0: not periodic.
#pragma once
#include <cmath>

#include "base/vec.h"

namespace gonogo::sim {

/// Position folded into [origin, origin + period) along periodic axes.
GONOGO_HD inline double folded(double x, double origin, double period) {
  if (period <= 0) return x;
  return x - period * std::floor((x - origin) / period);
}

/// Shortest periodic image of the difference between two points that lie less than 1.5 periods apart.
GONOGO_HD inline double nearest_image(double d, double period) {
  const double half = period / 2;
  return period <= 0 || (d <= half && d >= -half) ? d : d > 0 ? d - period : d + period;
}
GONOGO_HD inline Vec3d nearest_image(const Vec3d& d, const Vec3d& period) {
  return {nearest_image(d.x, period.x), nearest_image(d.y, period.y), d.z};
}

}  // namespace gonogo::sim
