// A large sphere among small ones in a tank that is shaken upright.
#pragma once
#include "pipeline/lab/scenes/tank.h"

namespace gonogo::lab {

struct NutSpec {
  TankSpec tank{.of = {.count = 4000}};
  double size_ratio = 4;    // of the large sphere to the small ones, of equal density
  double acceleration = 3;  // largest one of the tank, in g
  double frequency = 5;     // [Hz]
  double shaken = 10;       // [s]
};

/// One large sphere on the floor of a filled tank, which then moves up and down, in the tank's frame. Measured: heights
/// of its centre over the depth of the fill at the start and at the end. It rises (Brazil nut).
ManyScene nut_scene(const NutSpec& spec, const RunOn& on);

}  // namespace gonogo::lab
