// What a scene may not ask of its bodies and laws, and a run of its numerics. Host only.
#pragma once
#include <cstddef>

#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Throws InputError, naming world `w`, the body or materials and the number, for masses, places, orientations,
/// velocities, gravity and pair laws that are out of range or not finite.
void check_bodies(const SceneWorld& world, std::size_t w);

/// Throws InputError, naming the number, for a step, iterations or tolerances out of range.
void check_settings(const StepSettings& settings);

}  // namespace gonogo::sim
