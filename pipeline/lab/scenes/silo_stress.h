// Forces of spheres on the wall of a silo.
#pragma once
#include "sim/io/capture.h"

namespace gonogo::lab {

/// Sums over samples of a round silo about the z axis whose wall stands on z = 0.
struct WallStress {
  double normal = 0, shear = 0;  // forces of the wall on the spheres, inward and upward [N]
  double shear_moment = 0;       // upward forces times their heights [N m]
  double weight_moment = 0;      // weights times their heights [N m]

  /// `spheres`: the bodies before `wall`, which lie in the silo. `step`: of the contacts' impulses [s].
  void add(const sim::Capture& state, const sim::SceneWorld& world, Index spheres, sim::BodyIndex wall, double step);

  /// Upward force over the friction limit: 1 where friction is mobilised all over the wall [-].
  double mobilised(double friction) const { return shear / (friction * normal); }
  /// Janssen's K without his fit: mean pressure on the wall over the mean vertical stress [-]. Integrated over the
  /// height, the pressure is normal / (pi D). The stress is (weight_moment - shear_moment) / (pi D^2 / 4): a section
  /// carries the weight above it less the shear of the wall there.
  double ratio(double diameter) const { return normal * diameter / (4 * (weight_moment - shear_moment)); }
};

}  // namespace gonogo::lab
