// What a scene may not ask of its shapes. Host only.
#pragma once
#include <cstddef>

#include "sim/scene/scene.h"

namespace gonogo::sim {

const char* name_of(ShapeType type);

/// Throws InputError, naming world `w`, the shape and the number, for materials, sizes, lugs and orientations out of
/// range and for meshes and heightfields that are missing.
void check_shapes(const SceneWorld& world, std::size_t w);

/// Sets the sizes of the shapes that are meshes (distance of the furthest vertex, half of the smallest side of the box
/// around) and heightfields (distance of the furthest point). After check_shapes.
void set_surface_sizes(SceneWorld& world);

}  // namespace gonogo::sim
