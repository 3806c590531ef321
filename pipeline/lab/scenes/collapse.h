// A round column of spheres that falls apart when the wall around it is gone.
#pragma once
#include "pipeline/lab/scenes/scene.h"

namespace gonogo::lab {

struct CollapseSpec {
  Spheres of{.count = 4000, .friction = 0.5};
  double rolling_friction = 0.1;  // [-]
  double aspect = 1;              // height of the column over its radius, about
  double spread_time = 2;         // after the wall is gone [s]

  double radius() const;  // of the column [m]
};

/// The column settles at low friction inside a smooth cylinder of 48 chords on a plane. Then the cylinder goes and the
/// spheres get their own friction. Measured, with R_0 the radius of the cylinder:
///   aspect                 height over radius of the column just before: twice the height of its centre of mass
///   run_out_covered        (R - R_0) / R_0 with R of the outermost ring, a diameter wide, half covered by spheres
///   run_out_of_99_in_100   the same with 99 in 100 spheres within R, so with most that roll on by themselves
///   height_over_radius     height of the heap over R_0
ManyScene collapse_scene(const CollapseSpec& spec, const RunOn& on);

}  // namespace gonogo::lab
