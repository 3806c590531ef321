// What the pairs of a world may not be. Host only.
#pragma once
#include "sim/scene/flat_world.h"

namespace gonogo::sim {

/// Throws InputError, naming world `w`, both shapes and their bodies, for two shapes that may meet although their pair
/// has no routine. Shapes of one body, one group or one mechanism and of two fixed bodies never meet.
void check_pairs(const FlatWorld& flat, WorldIndex w);

/// Throws InputError, naming world `w`, both bodies, the overlap and the limit, for the first two shapes that overlap
/// by more than `limit` times the smaller of their least halves (a sphere's radius, half of a box's shortest edge).
void check_overlaps(const FlatWorld& flat, WorldIndex w, const StepSettings& settings, Real limit);

}  // namespace gonogo::sim
