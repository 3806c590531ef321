// Checks a world's elements and flattens them. Host only.
#pragma once
#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Throws InputError, naming world `w`, for an element with numbers out of range or indices outside of the world.
void check_elements(const SceneWorld& world, std::size_t w, const StepSettings& settings);

/// Elements of a checked world, with times rounded to steps.
FlatElements flat_elements(const SceneWorld& world, const StepSettings& settings);

}  // namespace gonogo::sim
