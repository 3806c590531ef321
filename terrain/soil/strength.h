// Strength of fine-grained soil as a cone sees it: from cohesion and friction angle to the index that vehicle cone
// indices (VCI1, VCI50) are compared with.
#pragma once
#include <cmath>
#include <numbers>

namespace gonogo::terrain {

inline constexpr double kPascalPerPsi = 6894.757;

/// Bearing capacity factor of cohesion under a strip (Prandtl 1921): (e^(pi tan phi) tan^2(45 + phi/2) - 1) cot phi;
/// 2 + pi without friction. `friction_angle` [deg].
inline double bearing_capacity_factor(double friction_angle) {
  const double phi = friction_angle * std::numbers::pi / 180;
  if (phi < 1e-6) return 2 + std::numbers::pi;
  const double half = std::tan(std::numbers::pi / 4 + phi / 2);
  return (std::exp(std::numbers::pi * std::tan(phi)) * half * half - 1) / std::tan(phi);
}

/// Cone index that cohesion alone gives fine-grained soil [Pa]: depth and round shape raise the strip's capacity from
/// 5.14 to 9 (Skempton 1951, "The bearing capacity of clays"). The weight of the soil above the cone is left out, so
/// that the index is rather too low. `cohesion` [Pa], `friction_angle` [deg].
inline double cone_index(double cohesion, double friction_angle) {
  return 9 / (2 + std::numbers::pi) * bearing_capacity_factor(friction_angle) * cohesion;
}

}  // namespace gonogo::terrain
