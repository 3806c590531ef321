// Cheapest ways in any direction.
//
// Dijkstra's search over 32 directions from both ends finds the way among obstacles: the steps (1,0), (1,1), (2,1),
// (3,1), (3,2) and their mirror images, each with the exact cost of the line between the cells' centres. On even ground
// such ways are at most 1 / cos(9.22 deg) - 1 = 1.3 % too long (square cells). pull_taut() then straightens the way by
// exact costs of longer lines.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "pipeline/map/route/search/cost.h"
#include "pipeline/map/route/search/search.h"

namespace gonogo::map {

/// Walks from the centre of cell `from` to that of cell `to` on a grid of `columns`, after Amanatides and Woo (1987),
/// in whole numbers. Calls enter(cell, begin, end) for each cell with the share of the line inside of it [0, 1], and
/// corner(cell, cell) for the two cells beside a corner that the line passes through. Either may return false to stop.
/// Returns whether the end was reached.
template <class Enter, class Corner>
bool walk_line(int columns, std::uint32_t from, std::uint32_t to, Enter enter, Corner corner) {
  const int row_from = int(from) / columns, row_to = int(to) / columns;
  const int dx = int(to) % columns - int(from) % columns, dy = row_to - row_from;
  const std::int64_t across = std::abs(dx), down = std::abs(dy);
  const std::int64_t step_x = dx < 0 ? -1 : 1, step_y = dy < 0 ? -std::int64_t(columns) : columns;
  std::int64_t cell = from, i = 0, j = 0;  // crossings of columns and rows so far
  double begin = 0;
  while (i < across || j < down) {
    // The next crossings lie at (2 i + 1) / (2 across) and (2 j + 1) / (2 down) of the line.
    const std::int64_t x = i < across ? (2 * i + 1) * down : 0, y = j < down ? (2 * j + 1) * across : 0;
    const bool cross_x = j >= down || (i < across && x <= y), cross_y = i >= across || (j < down && y <= x);
    const double end = cross_x ? double(2 * i + 1) / double(2 * across) : double(2 * j + 1) / double(2 * down);
    if (!enter(std::uint32_t(cell), begin, end)) return false;
    if (cross_x && cross_y && !corner(std::uint32_t(cell + step_x), std::uint32_t(cell + step_y))) return false;
    cell += (cross_x ? step_x : 0) + (cross_y ? step_y : 0);
    i += cross_x;
    j += cross_y;
    begin = end;
  }
  return enter(std::uint32_t(cell), begin, 1.0);
}
/// Past all corners.
template <class Enter>
bool walk_line(int columns, std::uint32_t from, std::uint32_t to, Enter enter) {
  return walk_line(columns, from, to, enter, [](std::uint32_t, std::uint32_t) { return true; });
}

/// Direction of so many columns to the east and rows to the south [deg clockwise from grid north], whole, [0, 360).
int heading_of(const RouteCells& cells, int columns, int rows);

/// A step, and what of its line lies in which cell. Offsets are differences of cell numbers.
struct LineStep {
  int column = 0, row = 0;
  std::ptrdiff_t offset = 0;
  int heading = 0;    // [deg clockwise from grid north]
  float length = 0;   // of the whole line [m]
  float between = 0;  // of what lies in neither the first nor the last cell [m]
  struct Piece {
    std::ptrdiff_t offset;
    float length;  // [m]
  };
  int pieces = 0, corners = 0;
  std::array<Piece, 6> piece{};
  std::array<std::ptrdiff_t, 2> corner{};  // cells beside the one corner that the line runs through

  /// `before` and the cost of the step from `cell`. Gives up once that is no less than `known`.
  float add_cost(const PackedCells& cells, std::size_t cell, float before, float known) const {
    float sum = before;
    for (int k = 0; k < pieces && sum < known; ++k) {
      const Piece& part = piece[std::size_t(k)];
      sum += part.length * cells.per_metre(std::size_t(std::ptrdiff_t(cell) + part.offset), heading);
    }
    return sum;
  }
};

/// Columns or rows of a step at most.
inline constexpr int kLongestStep = 3;

/// The 32 steps whose numbers of columns and rows have no common divisor and are at most kLongestStep, row by row. With
/// `backwards` they have the heading of the way back.
std::vector<LineStep> line_steps(const RouteCells& cells, bool backwards);

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

/// The cheapest way in the 32 steps, cell by cell; empty if there is none.
///
/// A search from either end: once the two radii together are no less than the cost of a way, none that costs less is
/// left (Pohl 1971). The searches run beside each other and are compared every `together` cells, so that the way is the
/// same for any number of threads.
std::vector<std::uint32_t> way_in_steps(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                        std::uint32_t end, std::size_t together = 1 << 16);

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
