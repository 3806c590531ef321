// A silo, filled and opened, and the forces of its spheres on its wall.
#pragma once
#include "pipeline/lab/scenes/scene.h"
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

struct SiloSpec {
  Spheres of;
  double slenderness = 3;        // height of the fill over the silo's diameter, about
  double orifice_diameters = 0;  // of the hole in the floor, in spheres; 0: a third of the silo's diameter
  double rolling_friction = 0;   // from the pull on; with it from the start, spheres would not settle
  double flow_time = 2;          // after the hole has been opened [s]

  double radius() const;          // of the silo [m]
  double orifice_radius() const;  // [m]
};

/// A cylinder with a flat floor, both meshes of 48 chords, filled from a lattice that falls onto floor and plug. Before
/// the opening, the wall is drawn upward for two seconds at a tenth of a diameter per second, which mobilises its
/// friction (Vanel & Clement 1999). Then the plug goes, and the flow falls onto a plane far below.
///
/// Measured over the second half of the pull, and watched: share of the weight on the floor, mobilised share of the
/// wall's friction, ratio of the pressure on the wall to the vertical stress. Also measured: height of the fill over
/// the silo's width; mean flow from a quarter of the flow time to its end.
ManyScene silo_scene(const SiloSpec& spec, const RunOn& on);

}  // namespace gonogo::lab
