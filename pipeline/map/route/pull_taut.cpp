#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/map/route/any_angle.h"

namespace gonogo::map {
namespace {

constexpr std::size_t kWindow = 200;  // corners that one line may replace
constexpr int kSweeps = 60;           // most rounds of moving corners

using Way = std::vector<std::uint32_t>;

struct Ground {
  const RouteCells& cells;
  const RouteCosts& costs;
  double line(std::uint32_t from, std::uint32_t to) const { return line_cost(cells, costs, from, to); }
};

/// The cheapest way over some of the corners, first and last among them.
Way selected(const Ground& ground, const Way& way) {
  std::vector<double> best(way.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> before(way.size(), 0);
  best[0] = 0;
  for (std::size_t j = 1; j < way.size(); ++j)
    for (std::size_t i = j > kWindow ? j - kWindow : 0; i < j; ++i) {
      const double sum = best[i] + ground.line(way[i], way[j]);
      if (sum < best[j]) {
        best[j] = sum;
        before[j] = i;
      }
    }
  Way corners;
  for (std::size_t j = way.size() - 1; j > 0; j = before[j]) corners.push_back(way[j]);
  corners.push_back(way[0]);
  std::reverse(corners.begin(), corners.end());
  return corners;
}

/// The cell beside `at`, or itself, over which the way from a to b costs least.
std::uint32_t best_beside(const Ground& ground, std::uint32_t a, std::uint32_t at, std::uint32_t b) {
  const int columns = ground.cells.columns, column = int(at) % columns, row = int(at) / columns;
  std::uint32_t best = at;
  double least = ground.line(a, at) + ground.line(at, b);
  for (int y = std::max(0, row - 1); y <= std::min(ground.cells.rows - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(columns - 1, column + 1); ++x) {
      const auto cell = std::uint32_t(y) * std::uint32_t(columns) + std::uint32_t(x);
      const double sum = ground.line(a, cell) + ground.line(cell, b);
      if (sum < least * (1 - 1e-12)) {
        least = sum;
        best = cell;
      }
    }
  return best;
}

void move_corners(const Ground& ground, Way& way) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool moved = false;
    for (std::size_t i = 1; i + 1 < way.size(); ++i) {
      const std::uint32_t better = best_beside(ground, way[i - 1], way[i], way[i + 1]);
      moved = moved || better != way[i];
      way[i] = better;
    }
    if (!moved) return;
  }
}

}  // namespace

FoundRoute pull_taut(const RouteCells& cells, const RouteCosts& costs, const std::vector<std::uint32_t>& way) {
  const Ground ground{cells, costs};
  FoundRoute route;
  route.cell = way;
  if (way.size() > 2) {
    route.cell = selected(ground, way);
    move_corners(ground, route.cell);
    route.cell = selected(ground, route.cell);
  }
  for (std::size_t i = 1; i < route.cell.size(); ++i) route.cost += ground.line(route.cell[i - 1], route.cell[i]);
  return route;
}

}  // namespace gonogo::map
