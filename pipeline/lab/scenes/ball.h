// A light ball that floats on many spheres.
#pragma once
#include "pipeline/lab/scenes/tank.h"

namespace gonogo::lab {

struct BallSpec {
  TankSpec tank{.of = {.count = 20'000}};
  double size_ratio = 10;         // of the ball to the spheres
  double relative_density = 0.5;  // of the ball to the bulk that it swims on
  double floated = 3;             // [s]
};

/// A ball laid onto a tank of smooth spheres, which are as fluid as spheres can be. Measured: share of the ball's
/// volume below the mean surface. Archimedes: `relative_density`.
ManyScene ball_scene(const BallSpec& spec, const RunOn& on);

}  // namespace gonogo::lab
