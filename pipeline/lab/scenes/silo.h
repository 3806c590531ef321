// A silo: filled, then opened.
#pragma once
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/spheres.h"

namespace gonogo::lab {

struct SiloSpec {
  Spheres of;
  double slenderness = 3;        // height of the fill over the silo's diameter, about
  double orifice_diameters = 0;  // of the hole in the floor, in spheres; 0: a third of the silo's diameter
  double rolling_friction = 0;   // from when the wall is moved; settling with it, spheres would stay as they were laid
  double flow_time = 2;          // after the hole has been opened [s]

  double radius() const;          // of the silo [m]
  double orifice_radius() const;  // [m]
};

/// A cylinder with a flat floor, both meshes of 48 chords, filled from a lattice that falls onto floor and plug. For
/// two seconds before the opening the wall is drawn upward by a tenth of a diameter a second, so that its friction
/// carries what it can (Vanel & Clement 1999). Then the plug is gone; what flows out falls onto a plane far below.
/// Measured over the second half of the pull: share of the weight that the floor carries, how far friction is mobilised
/// on the wall, ratio of the pressure on the wall to the vertical stress; height of the fill over the silo's width; the
/// mean flow between a quarter and all of the flow time. Watched: the first three.
ManyScene silo_scene(const SiloSpec& spec, const RunOn& on);

}  // namespace gonogo::lab
