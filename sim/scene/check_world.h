// Checks bodies, laws and settings. Host only.
#pragma once
#include <cstddef>

#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Throws InputError, naming world `w` and the number, for masses, positions, orientations, velocities, gravity and
/// laws that are out of range or not finite.
void check_bodies(const SceneWorld& world, std::size_t w);

/// Throws InputError, naming the number, for a step, iterations or tolerances out of range.
void check_settings(const StepSettings& settings);

}  // namespace gonogo::sim
