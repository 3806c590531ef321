// Refusal of joints, springs and motors that cannot work.
#pragma once
#include <string>

#include "sim/scene/scene.h"

namespace gonogo::sim {

/// A joint's points may be this far apart and its directions turned this much at the start [m, rad].
inline constexpr double kMaxStartError = 1e-3;

/// Throws InputError, beginning with `where`.
void check_mechanisms(const SceneWorld& world, const std::string& where);

}  // namespace gonogo::sim
