// What a vehicle's heading makes of the slope of the ground.
#pragma once
#include <cmath>

#include "base/units.h"

namespace gonogo::map {

/// Slope along the heading (uphill positive) and across it (left side up positive) [deg].
struct BedSlopes {
  double along = 0, across = 0;
};

/// `slope` [deg] of the ground; psi [rad] from the heading to the uphill direction of the fall line, positive to the
/// left (docs/notation.md). tan(along) = tan(slope) cos(psi), tan(across) = tan(slope) sin(psi).
inline BedSlopes bed_slopes(double slope, double psi) {
  const double rise = std::tan(slope * kDegree);
  return {std::atan(rise * std::cos(psi)) / kDegree, std::atan(rise * std::sin(psi)) / kDegree};
}

/// psi [rad] for a heading [deg clockwise from grid north] on ground that falls towards `aspect` [deg, likewise].
inline double fall_line_angle(double heading, double aspect) { return (heading - aspect - 180) * kDegree; }

/// Aspects are rounded to whole degrees before headings are compared with them.
inline double rounded_aspect(double aspect) { return std::fmod(std::round(aspect), 360.0); }

/// Headings that "worst" and "best" are taken over: 0 (uphill), 10, ... 350 degrees from the fall line.
inline constexpr int kHeadings = 36;

}  // namespace gonogo::map
