// Checks joints, springs and motors. Host only.
#pragma once
#include <string>

#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Max error of a joint at the start: distance of its points, angle between its directions [m, rad].
inline constexpr double kMaxStartError = 1e-3;

/// Throws InputError, beginning with `where`, for numbers out of range and for bodies that a joint cannot hold.
void check_mechanisms(const SceneWorld& world, const std::string& where);

}  // namespace gonogo::sim
