// Host-side preparation of the elements of a scene: checks, indices of the batch, times in steps.
#pragma once
#include "sim/scene.h"

namespace gonogo::sim {

/// Where a world's bodies, motors and springs begin in the batch.
struct WorldOffsets {
  BodyIndex first_body = 0;
  Index first_motor = 0, first_spring = 0;
};

/// Appends the elements of world `w`. Throws InputError for one that cannot run.
void append_elements(const SceneWorld& world, std::size_t w, const WorldOffsets& at, const StepSettings& settings,
                     FlatElements& flat);

}  // namespace gonogo::sim
