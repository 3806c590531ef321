// A silo: filled, then opened.
#pragma once
#include "pipeline/scenes/scene.h"
#include "pipeline/scenes/spheres.h"

namespace gonogo::pipeline {

struct SiloSpec {
  Spheres of;
  double slenderness = 3;        // height of the fill over the silo's diameter, about
  double orifice_diameters = 0;  // of the hole in the floor, in spheres; 0: a third of the silo's diameter
  double flow_time = 2;          // after the hole has been opened [s]

  double radius() const;          // of the silo [m]
  double orifice_radius() const;  // [m]
};

/// A cylinder with a flat floor, both meshes of 48 chords, filled from a lattice that falls onto floor and plug. Over
/// the last quarter of the time before the opening the wall is drawn upward by half a diameter a second, so that its
/// friction carries what it can (Vanel & Clement 1999). Then the plug is gone; what flows out falls onto a plane far
/// below. Measured: share of the weight that the floor carries while the wall moves; height of the fill over the silo's
/// width; the mean flow between a quarter and all of the flow time.
ManyScene silo_scene(const SiloSpec& spec, const RunOn& on);

}  // namespace gonogo::pipeline
