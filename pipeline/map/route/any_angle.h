// Cheapest ways in any direction.
//
// Dijkstra's search over 32 directions finds the way among obstacles: the steps (1,0), (1,1), (2,1), (3,1), (3,2) and
// their mirror images, each with the exact cost of the line between the cells' centres. On even ground such ways are at
// most 1 / cos(9.22 deg) - 1 = 1.3 % too long (square cells). pull_taut() then straightens the way by exact costs of
// longer lines.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/map/route/cost.h"
#include "pipeline/map/route/search.h"

namespace gonogo::map {

/// A straight line from centre to centre.
struct LineOfCells {
  LineOfCells(const RouteCells& cells, std::uint32_t from, std::uint32_t to);
  int heading;    // [deg clockwise from grid north], whole; 0 for a line of no length
  double length;  // map distance [m]
};

/// Cost of the straight line from centre to centre [unit_of(cost)]. The heading is rounded to whole degrees, and every
/// cell counts by the length of the line inside of it. Infinite if a cell cannot be passed in this heading, or if the
/// line runs through a corner beside a cell that no heading passes.
double line_cost(const RouteCells& cells, const RouteCosts& costs, std::uint32_t from, std::uint32_t to);

/// The cheapest way; nothing if there is none. FoundRoute::cell holds the corners of the way. Always the same result.
std::optional<FoundRoute> find_any_angle(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                         std::uint32_t end);

/// Min cost from `start` to every cell over the 32 directions [cell]; with `backwards`, from every cell to `start`. No
/// way: infinity.
std::vector<float> reach_any_angle(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                   bool backwards = false);

/// Straightens a way: takes the cheapest selection of its corners (dynamic programming over windows of corners), then
/// moves corners to neighbouring cells while that makes the way cheaper, and selects again. The result costs no more.
FoundRoute pull_taut(const RouteCells& cells, const RouteCosts& costs, const std::vector<std::uint32_t>& way);

}  // namespace gonogo::map
