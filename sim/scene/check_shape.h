// Checks shapes. Host only.
#pragma once
#include <cstddef>

#include "sim/scene/scene.h"

namespace gonogo::sim {

const char* name_of(ShapeType type);

/// Throws InputError, naming world `w`, the shape and the number, for materials, sizes, lugs and orientations out of
/// range. Refuses missing meshes and heightfields too.
void check_shapes(const SceneWorld& world, std::size_t w);

/// Sets Shape::size of meshes to (reach_of, min_half_of, -) and of heightfields to (reach_of, -, -). Call after
/// check_shapes().
void set_surface_sizes(SceneWorld& world);

}  // namespace gonogo::sim
