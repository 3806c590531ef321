#include "pipeline/map/route/line_step.h"

#include <cmath>
#include <numeric>

#include "base/units.h"
#include "pipeline/map/route/line_walk.h"

namespace gonogo::map {
namespace {

LineStep make_step(const RouteCells& cells, int column, int row, bool backwards) {
  LineStep step{.column = column, .row = row, .offset = std::ptrdiff_t(row) * cells.columns + column};
  step.heading = backwards ? heading_of(cells, -column, -row) : heading_of(cells, column, row);
  const double length = std::hypot(column * cells.cell_width, row * cells.cell_height);
  // On a grid of its own, wide enough for every step, from a cell in the middle.
  constexpr int columns = 9, middle = 4 * columns + 4;
  const auto offset_of = [&](std::uint32_t cell) {
    return std::ptrdiff_t(int(cell) / columns - 4) * cells.columns + int(cell) % columns - 4;
  };
  walk_line(
      columns, middle, std::uint32_t(middle + row * columns + column),
      [&](std::uint32_t cell, double begin, double end) {
        step.piece[std::size_t(step.pieces++)] = {offset_of(cell), float(length * (end - begin))};
        return true;
      },
      [&](std::uint32_t a, std::uint32_t b) {
        step.corner = {offset_of(a), offset_of(b)};
        step.corners = 2;
        return true;
      });
  return step;
}

}  // namespace

int heading_of(const RouteCells& cells, int columns, int rows) {
  return (int(std::lround(std::atan2(columns * cells.cell_width, -rows * cells.cell_height) / kDegree)) + 360) % 360;
}

std::vector<LineStep> line_steps(const RouteCells& cells, bool backwards) {
  std::vector<LineStep> steps;
  for (int row = -3; row <= 3; ++row)
    for (int column = -3; column <= 3; ++column)
      if (std::gcd(row, column) == 1) steps.push_back(make_step(cells, column, row, backwards));
  return steps;
}

}  // namespace gonogo::map
