// The contact law that a solution satisfies. Names: sim/scene/target_name.h.
#pragma once
#include <cstdint>

namespace gonogo::sim {

/// `ccp`: the convex relaxation of Anitescu, in which a sliding contact opens at mu |v_t|. `coulomb`: Coulomb's law,
/// reached by iterating on that term (De Saxce & Feng 1998).
enum class Target : std::int32_t { ccp, coulomb };

}  // namespace gonogo::sim
