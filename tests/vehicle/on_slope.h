// Demands on inclined planes.
#pragma once
#include <cmath>

#include "base/units.h"
#include "vehicle/feasible/feasible.h"

namespace gonogo::vehicle {

/// Slopes along and across [deg], uphill and left side higher positive.
inline Demand on_slope(double along, double across, double friction, bool moving = true) {
  const double a = std::tan(along * kDegree), b = std::tan(across * kDegree), n = std::sqrt(1 + a * a + b * b);
  Demand d;
  d.gravity = Vec3d{a, b, 1} * (-kGravity / n);
  d.friction = friction;
  d.moving = moving;
  return d;
}

}  // namespace gonogo::vehicle
