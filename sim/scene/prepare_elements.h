// Host-side preparation of a world's elements: checks, times in steps.
#pragma once
#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Throws InputError for an element that cannot run; `w` is the world's name in the message.
void check_elements(const SceneWorld& world, std::size_t w, const StepSettings& settings);

/// Elements of a checked world.
FlatElements flat_elements(const SceneWorld& world, const StepSettings& settings);

}  // namespace gonogo::sim
