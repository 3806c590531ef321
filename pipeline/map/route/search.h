// Cheapest ways over the cells of a map.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/map/route/cost.h"

namespace gonogo::map {

struct FoundRoute {
  double cost = 0;
  std::vector<std::uint32_t> cell;  // from start to end, neighbours of each other
};

/// Dijkstra 1959; nothing when no way is known to be passable. Equal costs: the cell found first, always the same.
std::optional<FoundRoute> find_route(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                     std::uint32_t end);

/// Least cost from `start` to every cell, or with `backwards` from every cell to it; infinity where there is no way.
std::vector<float> reach(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start, bool backwards = false);

/// Connected regions: number of the region of each cell, -1 where no heading passes. Two cells are connected when steps
/// between them exist in both directions under `costs`. Regions are numbered by their first cell.
std::vector<std::int32_t> connected_regions(const RouteCells& cells, const RouteCosts& costs);

}  // namespace gonogo::map
