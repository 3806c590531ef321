// Cone index of fine-grained soil from cohesion and friction angle. It is compared with the vehicle cone indices VCI1
// and VCI50.
#pragma once
#include <cmath>

#include "base/units.h"

namespace gonogo::terrain {

/// Bearing capacity factor of cohesion under a strip (Prandtl 1921): (e^(pi tan phi) tan^2(45 + phi/2) - 1) cot phi;
/// 2 + pi without friction. `friction_angle` [deg].
inline double bearing_capacity_factor(double friction_angle) {
  const double phi = to_radians(friction_angle);
  if (phi < 1e-6) return 2 + kPi;
  const double half = std::tan(kPi / 4 + phi / 2);
  return (std::exp(kPi * std::tan(phi)) * half * half - 1) / std::tan(phi);
}

/// Bearing capacity factor of the load beside a strip (Reissner 1924): e^(pi tan phi) tan^2(45 + phi/2); 1 without
/// friction. `friction_angle` [deg].
inline double surcharge_factor(double friction_angle) {
  return 1 + bearing_capacity_factor(friction_angle) * std::tan(to_radians(friction_angle));
}

/// Overburden [Pa] at 6 inches: the middle of the layer from 3 to 9 inches in which cone indices are read for wheel
/// loads below 2,000 lb (ERDC/GSL SR-13-2). 1,500 kg/m^3 is a light moist soil.
inline constexpr double kOverburden = 1500 * kGravity * 0.1524;

/// Cone index of fine-grained soil [Pa], as Terzaghi's sum of the bearing capacities of cohesion and overburden. Depth
/// and round shape raise the strip's factor of cohesion from 5.14 to 9 (Skempton 1951, "The bearing capacity of
/// clays"). The factor of overburden is not raised, so that the index is an underestimate. `cohesion` [Pa],
/// `friction_angle` [deg].
inline double cone_index(double cohesion, double friction_angle) {
  const double of_cohesion = 9 / (2 + kPi) * bearing_capacity_factor(friction_angle) * cohesion;
  return of_cohesion + surcharge_factor(friction_angle) * kOverburden;
}

}  // namespace gonogo::terrain
