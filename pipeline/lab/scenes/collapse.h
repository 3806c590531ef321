// A round column of spheres that falls apart when the wall around it is gone.
#pragma once
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/spheres.h"

namespace gonogo::lab {

struct CollapseSpec {
  Spheres of{.count = 4000, .friction = 0.5};
  double rolling_friction = 0.1;  // [-]
  double aspect = 1;              // height of the column over its radius, about
  double spread_time = 2;         // after the wall is gone [s]

  double radius() const;  // of the column [m]
};

/// Settled at little friction inside of a smooth cylinder of 48 chords on a plane, which is then gone, and the spheres
/// as rough as they are. Measured: height over radius of the
/// column just before, as twice the height of its centre of mass; run-out (R - R_0) / R_0, where R is the radius of the
/// outermost ring, a diameter wide, whose ground spheres cover to a half (the heap), and within which 99 in 100 of them
/// lie (with most of those that roll on by themselves); height of the heap over R_0.
ManyScene collapse_scene(const CollapseSpec& spec, const RunOn& on);

}  // namespace gonogo::lab
