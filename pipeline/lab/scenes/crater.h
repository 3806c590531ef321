// A ball dropped onto a bed of spheres.
#pragma once
#include "pipeline/lab/scenes/tank.h"

namespace gonogo::lab {

struct CraterSpec {
  TankSpec tank{.of = {.count = 8000}};
  double size_ratio = 5;   // of the ball to the spheres
  double density = 2600;   // of the ball [kg/m^3]
  double drop_height = 1;  // of its lowest point over the surface [m]
  double watched = 0.8;    // after it has touched the surface [s]
};

/// The ball starts at the surface with the speed of its fall. Measured at the end [m]: depth of its lowest point below
/// the surface, and H = drop height + depth. Experiments find depth ~ H^(1/3) (Uehara et al. 2003).
ManyScene crater_scene(const CraterSpec& spec, const RunOn& on);

}  // namespace gonogo::lab
