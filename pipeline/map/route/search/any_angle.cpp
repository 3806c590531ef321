#include "pipeline/map/route/search/any_angle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "base/units.h"

namespace gonogo::map {

namespace {

LineStep make_step(const RouteCells& cells, int column, int row, bool backwards) {
  LineStep step{.column = column, .row = row, .offset = std::ptrdiff_t(row) * cells.columns + column};
  step.heading = backwards ? heading_of(cells, -column, -row) : heading_of(cells, column, row);
  const double length = std::hypot(column * cells.cell_width, row * cells.cell_height);
  step.length = float(length);
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
  step.between = step.length - 2 * step.piece[0].length;
  return step;
}

}  // namespace

int heading_of(const RouteCells& cells, int columns, int rows) {
  return (int(std::lround(std::atan2(columns * cells.cell_width, -rows * cells.cell_height) / kDegree)) + 360) % 360;
}

std::vector<LineStep> line_steps(const RouteCells& cells, bool backwards) {
  std::vector<LineStep> steps;
  for (int row = -kLongestStep; row <= kLongestStep; ++row)
    for (int column = -kLongestStep; column <= kLongestStep; ++column)
      if (std::gcd(row, column) == 1) steps.push_back(make_step(cells, column, row, backwards));
  return steps;
}

namespace {

constexpr float kImpassable = RouteCosts::kImpassable;

/// Dijkstra's search, some cells at a time.
class Search {
 public:
  Search(const RouteCells& cells, const RouteCosts& costs, const PackedCells& packed, std::uint32_t start,
         bool backwards)
      : cost(packed.size(), kImpassable),
        before(packed.size()),
        columns_(cells.columns),
        rows_(cells.rows),
        cells_(packed),
        steps_(line_steps(cells, backwards)),
        least_(costs.least_per_metre()),
        queue_(cost) {
    cost[start] = 0;
    before[start] = start;
    queue_.push(start);
  }

  /// Goes on from the next `count` cells, or from all that are left. Calls settled(cell) for each.
  template <class Settled>
  void advance(std::size_t count, const Settled& settled) {
    for (std::size_t taken = 0; taken < count && !queue_.empty(); ++taken) {
      if ((taken & 0xffff) == 0) stop_if_cancelled();
      const std::size_t cell = queue_.top();
      queue_.pop();
      expand(cell);
      settled(std::uint32_t(cell));
    }
  }
  /// No cell that is still to be settled costs less.
  float radius() const { return queue_.empty() ? kImpassable : cost[queue_.top()]; }

  std::vector<float> cost;
  std::vector<std::uint32_t> before;

 private:
  void expand(std::size_t cell) {
    const int column = int(cell % std::size_t(columns_)), row = int(cell / std::size_t(columns_));
    const bool inside = std::min({column, row, columns_ - 1 - column, rows_ - 1 - row}) >= kLongestStep;
    const float here = cost[cell], least_here = cells_.least_per_metre(cell);
    for (const LineStep& step : steps_) {
      if (!inside && leaves_map(column + step.column, row + step.row)) continue;
      const std::size_t to = std::size_t(std::ptrdiff_t(cell) + step.offset);
      const float known = cost[to];
      if (known <= std::max(here, kRounded * (here + step.length * least_))) continue;
      if (!cells_.passable(to)) continue;
      const float ends = step.piece[0].length * (least_here + cells_.least_per_metre(to));
      if (known <= kRounded * (here + ends + step.between * least_)) continue;
      const float sum = cost_over(step, cell, known);
      if (!(sum < known)) continue;
      cost[to] = sum;
      before[to] = std::uint32_t(cell);
      queue_.push(to);
    }
  }
  bool leaves_map(int column, int row) const { return column < 0 || row < 0 || column >= columns_ || row >= rows_; }

  /// Cost of the way to `cell` and the step. Gives up once that is no less than `known`.
  float cost_over(const LineStep& step, std::size_t cell, float known) const {
    for (int k = 0; k < step.corners; ++k)
      if (!cells_.passable(std::size_t(std::ptrdiff_t(cell) + step.corner[std::size_t(k)]))) return kImpassable;
    return step.add_cost(cells_, cell, cost[cell], known);
  }

  int columns_, rows_;
  const PackedCells& cells_;
  std::vector<LineStep> steps_;
  static constexpr float kRounded = 0.999999f;  // what rounding leaves at least of a sum over a step
  float least_;                                 // cost per metre
  NearestFirst queue_;
};

}  // namespace

std::vector<std::uint32_t> way_in_steps(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                        std::uint32_t end, std::size_t together) {
  const PackedCells packed(cells, costs);
  std::array<Search, 2> search = {Search(cells, costs, packed, start, false), Search(cells, costs, packed, end, true)};
  const auto over = [&](std::uint32_t cell) { return double(search[0].cost[cell]) + double(search[1].cost[cell]); };
  double known = std::numeric_limits<double>::infinity();
  while (double(search[0].radius()) + double(search[1].radius()) < known) {
    std::array<std::vector<std::uint32_t>, 2> settled;
    for_each_on_host(2, 1, [&](std::size_t side) {
      search[side].advance(together, [&](std::uint32_t cell) { settled[side].push_back(cell); });
    });
    for (const std::vector<std::uint32_t>& cells_of_side : settled)
      for (const std::uint32_t cell : cells_of_side) known = std::min(known, over(cell));
  }
  std::uint32_t middle = start;  // the way may also pass a cell that only one search has settled
  for (std::uint32_t cell = 0; cell < packed.size(); ++cell)
    if (over(cell) < over(middle)) middle = cell;
  if (!std::isfinite(over(middle))) return {};
  std::vector<std::uint32_t> way = {middle};
  while (way.back() != start) way.push_back(search[0].before[way.back()]);
  std::reverse(way.begin(), way.end());
  while (way.back() != end) way.push_back(search[1].before[way.back()]);
  return way;
}

LineOfCells::LineOfCells(const RouteCells& cells, std::uint32_t from, std::uint32_t to) {
  const int columns = int(to) % cells.columns - int(from) % cells.columns;
  const int rows = int(to) / cells.columns - int(from) / cells.columns;
  heading = heading_of(cells, columns, rows);
  length = std::hypot(columns * cells.cell_width, rows * cells.cell_height);
}

double line_cost(const RouteCells& cells, const RouteCosts& costs, std::uint32_t from, std::uint32_t to) {
  if (from == to) return 0;
  const LineOfCells line(cells, from, to);
  double sum = 0;
  const bool passes = walk_line(
      cells.columns, from, to,
      [&](std::uint32_t cell, double begin, double end) {
        sum += line.length * (end - begin) * double(costs.per_metre(cells, cell, line.heading));
        return std::isfinite(sum);
      },
      [&](std::uint32_t a, std::uint32_t b) { return costs.ever_passable(cells, a) && costs.ever_passable(cells, b); });
  return passes ? sum : std::numeric_limits<double>::infinity();
}

std::optional<FoundRoute> find_any_angle(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                         std::uint32_t end) {
  const std::vector<std::uint32_t> way = way_in_steps(cells, costs, start, end);
  if (way.empty()) return std::nullopt;
  return pull_taut(cells, costs, way);
}

std::vector<float> reach_any_angle(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                   bool backwards) {
  const PackedCells packed(cells, costs);
  Search search(cells, costs, packed, start, backwards);
  search.advance(packed.size(), [](std::uint32_t) {});
  return std::move(search.cost);
}

namespace {

constexpr std::size_t kWindow = 200;  // corners that one line may replace
constexpr std::size_t kLinesAtOnce = 1024;
constexpr int kSweeps = 60;  // most rounds of moving corners

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
  const auto first_before = [](std::size_t j) { return j > kWindow ? j - kWindow : 0; };
  std::vector<std::array<double, kWindow>> lines(std::min(way.size(), kLinesAtOnce));  // to a corner, from those before
  for (std::size_t begin = 1; begin < way.size(); begin += lines.size()) {
    const std::size_t end = std::min(way.size(), begin + lines.size());
    for_each_on_host(end - begin, 1, [&](std::size_t k) {
      const std::size_t j = begin + k, first = first_before(j);
      for (std::size_t i = first; i < j; ++i) lines[k][i - first] = ground.line(way[i], way[j]);
    });
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = first_before(j); i < j; ++i) {
        const double sum = best[i] + lines[j - begin][i - first_before(j)];
        if (sum < best[j]) {
          best[j] = sum;
          before[j] = i;
        }
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
