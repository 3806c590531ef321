// A silo: filled, then opened.
#pragma once
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/spheres.h"

namespace gonogo::lab {

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
