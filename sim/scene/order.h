// The order of bodies in memory: along a space-filling curve, so that neighbours in space, which the solver reads
// together, are neighbours in memory.
#pragma once
#include <vector>

#include "sim/state/world.h"

namespace gonogo::sim {

/// Index in the list -> place along the curve of Morton (1966) through the world's bins. Bodies of one bin keep their
/// order.
std::vector<BodyIndex> spatial_order(const std::vector<Vec3d>& position, const WorldParameters& world);

/// The same with 1023 cells a side of the cube around all positions instead of bins.
std::vector<Index> order_along_curve(const std::vector<Vec3d>& position);

/// Whether sorting pays: compares, before and after, how many bodies have their successor in memory in the same or an
/// adjacent bin. `place`: from spatial_order().
bool have_mixed(const std::vector<Vec3d>& position, const std::vector<BodyIndex>& place, const WorldParameters& world);

/// Order `first`, then order `second`.
std::vector<BodyIndex> composed(const std::vector<BodyIndex>& first, const std::vector<BodyIndex>& second);

}  // namespace gonogo::sim
