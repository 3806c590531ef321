// The order of bodies in memory: along a space-filling curve, so that neighbours in space are neighbours in memory.
// What the solver gathers for a contact then mostly lies together.
#pragma once
#include <vector>

#include "sim/state/state.h"

namespace gonogo::sim {

/// Index in the list -> place along the curve of Morton (1966) through the world's bins. Bodies of one bin keep their
/// order.
std::vector<BodyIndex> spatial_order(const std::vector<Vec3d>& position, const WorldParameters& world);

/// The same along the curve through 1023 cells a side of the cube around all of them.
std::vector<Index> order_along_curve(const std::vector<Vec3d>& position);

/// Whether sorting pays. `place`: what spatial_order() returns. Counted are the bodies whose successor in memory lies
/// in the same bin or in one beside it.
bool have_mixed(const std::vector<Vec3d>& position, const std::vector<BodyIndex>& place, const WorldParameters& world);

/// One order after another.
std::vector<BodyIndex> composed(const std::vector<BodyIndex>& first, const std::vector<BodyIndex>& second);

}  // namespace gonogo::sim
