// Cheapest ways over the cells of a map, by Dijkstra's algorithm (1959).
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

/// The cheapest way from `start` to `end`; nothing if there is none. Ties are broken by cell number, so the result is
/// always the same.
std::optional<FoundRoute> find_route(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                     std::uint32_t end);

/// Min cost from `start` to every cell [cell]; with `backwards`, from every cell to `start`. No way: infinity.
std::vector<float> reach(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start, bool backwards = false);

/// Number of the connected region of each cell [cell]; -1 if no heading passes. Two neighbours are connected if `costs`
/// allows the steps in both directions. Regions are numbered in the order of their first cell.
std::vector<std::int32_t> connected_regions(const RouteCells& cells, const RouteCosts& costs);

}  // namespace gonogo::map
