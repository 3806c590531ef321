// Slopes along and across the heading of a vehicle, from slope and aspect of the ground.
#pragma once
#include <cmath>

#include "base/units.h"

namespace gonogo::map {

/// Slope along the heading (uphill positive) and across it (left side up positive) [deg].
struct BedSlopes {
  double along = 0, across = 0;
};

/// `slope`: of the ground [deg]. psi: angle from the heading to the uphill direction of the fall line [rad], positive
/// to the left (docs/notation.md). tan(along) = tan(slope) cos(psi), tan(across) = tan(slope) sin(psi).
inline BedSlopes bed_slopes(double slope, double psi) {
  const double rise = std::tan(slope * kDegree);
  return {std::atan(rise * std::cos(psi)) / kDegree, std::atan(rise * std::sin(psi)) / kDegree};
}

/// psi [rad] for a heading [deg clockwise from grid north] on ground that falls towards `aspect` [deg, likewise].
inline double fall_line_angle(double heading, double aspect) { return (heading - aspect - 180) * kDegree; }

/// Aspect in whole degrees [0, 360). The map and its page round alike, so they look up the same entries.
inline double rounded_aspect(double aspect) { return std::fmod(std::round(aspect), 360.0); }

/// Number of headings that "worst" and "best" are taken over: 0 (uphill), 10, ... 350 degrees from the fall line.
inline constexpr int kHeadings = 36;

}  // namespace gonogo::map
