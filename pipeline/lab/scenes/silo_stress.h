// How spheres press on the wall of a silo.
#pragma once
#include "sim/io/capture.h"

namespace gonogo::lab {

/// Sums over looks at a round silo about the z axis whose wall stands on z = 0.
struct WallStress {
  double normal = 0, shear = 0;  // forces of the wall on the spheres, inward and upward [N]
  double shear_moment = 0;       // upward forces times their heights [N m]
  double weight_moment = 0;      // weights times their heights [N m]

  /// `spheres`: the bodies before `wall` that lie in the silo; `step`: what turns impulses into forces [s].
  void add(const sim::Capture& state, const sim::SceneWorld& world, Index spheres, sim::BodyIndex wall, double step);

  /// Upward force over what friction allows: 1 where it is mobilised all over the wall [-].
  double mobilised(double friction) const { return shear / (friction * normal); }
  /// Janssen's K without his fit: mean pressure on the wall over the mean vertical stress. Over the height the pressure
  /// adds up to normal / (pi D), the stress to (weight_moment - shear_moment) / (pi D^2 / 4), because a section carries
  /// what lies above it less what the wall there carries.
  double ratio(double diameter) const { return normal * diameter / (4 * (weight_moment - shear_moment)); }
};

}  // namespace gonogo::lab
