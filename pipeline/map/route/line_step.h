// Steps of the searches in many directions: lines from a cell's centre to one up to three columns and rows away.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "pipeline/map/route/cost.h"

namespace gonogo::map {

/// Direction of so many columns to the east and rows to the south [deg clockwise from grid north], whole, [0, 360).
int heading_of(const RouteCells& cells, int columns, int rows);

/// A step, and what of its line lies in which cell. Offsets are differences of cell numbers.
struct LineStep {
  int column = 0, row = 0;
  std::ptrdiff_t offset = 0;
  int heading = 0;  // [deg clockwise from grid north]
  struct Piece {
    std::ptrdiff_t offset;
    float length;  // [m]
  };
  int pieces = 0, corners = 0;
  std::array<Piece, 6> piece{};
  std::array<std::ptrdiff_t, 2> corner{};  // cells beside the one corner that the line runs through

  /// `before` and the cost of the step from `cell`. Gives up once that is no less than `known`.
  float add_cost(const RouteCells& cells, const RouteCosts& costs, std::size_t cell, float before, float known) const {
    float sum = before;
    for (int k = 0; k < pieces && sum < known; ++k) {
      const Piece& part = piece[std::size_t(k)];
      sum += part.length * costs.per_metre(cells, std::size_t(std::ptrdiff_t(cell) + part.offset), heading);
    }
    return sum;
  }
};

/// The 32 steps whose numbers of columns and rows have no common divisor and are at most three, row by row. With
/// `backwards` they have the heading of the way back.
std::vector<LineStep> line_steps(const RouteCells& cells, bool backwards);

}  // namespace gonogo::map
