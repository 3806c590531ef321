// Checks pairs of shapes. Host only.
#pragma once
#include "sim/scene/flat_world.h"

namespace gonogo::sim {

/// Throws InputError, naming world `w`, both shapes and their bodies, for two shapes that may touch although no routine
/// handles their types. Shapes of one body, one group, one mechanism or two fixed bodies never touch.
void check_pairs(const FlatWorld& flat, WorldIndex w);

/// Throws InputError for the first two shapes that overlap by more than `limit` times the smaller of their
/// smallest_half. The message names world `w`, both bodies, the overlap and the limit.
void check_overlaps(const FlatWorld& flat, WorldIndex w, const StepSettings& settings, Real limit);

}  // namespace gonogo::sim
