// Checks of a scene: bodies, laws, settings, shapes, joints, and pairs of shapes. Host only.
#pragma once
#include <cstddef>
#include <string>

#include "sim/scene/flat_world.h"
#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Throws InputError, naming world `w` and the number, for masses, positions, orientations, velocities, gravity and
/// laws that are out of range or not finite.
void check_bodies(const SceneWorld& world, std::size_t w);

/// Throws InputError, naming the number, for a step, iterations or tolerances out of range.
void check_settings(const StepSettings& settings);

const char* name_of(ShapeType type);

/// Throws InputError, naming world `w`, the shape and the number, for materials, sizes, lugs and orientations out of
/// range. Refuses missing meshes and heightfields too.
void check_shapes(const SceneWorld& world, std::size_t w);

/// Sets Shape::size of meshes to (reach_of, min_half_of, -) and of heightfields to (reach_of, -, -). Call after
/// check_shapes().
void set_surface_sizes(SceneWorld& world);

/// Max error of a joint at the start: distance of its points, angle between its directions [m, rad].
inline constexpr double kMaxStartError = 1e-3;

/// Throws InputError, beginning with `where`, for numbers out of range and for bodies that a joint cannot hold.
void check_mechanisms(const SceneWorld& world, const std::string& where);

/// Throws InputError, naming world `w`, both shapes and their bodies, for two shapes that may touch although no routine
/// handles their types. Shapes of one body, one group, one mechanism or two fixed bodies never touch.
void check_pairs(const FlatWorld& flat, WorldIndex w);

/// Throws InputError for the first two shapes that overlap by more than `limit` times the smaller of their
/// smallest_half. The message names world `w`, both bodies, the overlap and the limit.
void check_overlaps(const FlatWorld& flat, WorldIndex w, const StepSettings& settings, Real limit);

}  // namespace gonogo::sim
