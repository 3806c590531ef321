#include "pipeline/map/route/any_angle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/cancel.h"
#include "pipeline/map/route/line_step.h"
#include "pipeline/map/route/line_walk.h"
#include "pipeline/map/route/nearest_first.h"

namespace gonogo::map {
namespace {

constexpr float kImpassable = RouteCosts::kImpassable;
constexpr std::size_t kAnywhere = std::size_t(-1);

class Search {
 public:
  Search(const RouteCells& cells, const RouteCosts& costs, bool backwards)
      : cells_(cells), costs_(costs), steps_(line_steps(cells, backwards)), passable_(cells.soil.size()) {
#pragma omp parallel for schedule(static)
    for (std::size_t c = 0; c < passable_.size(); ++c) passable_[c] = costs.ever_passable(cells, c);
    cost.assign(passable_.size(), kImpassable);
    before.resize(passable_.size());
  }

  void run(std::size_t start, std::size_t end) {
    cost[start] = 0;
    before[start] = std::uint32_t(start);
    NearestFirst queue(cost);
    queue.push(start);
    for (std::size_t taken = 0; !queue.empty(); ++taken) {
      const std::size_t cell = queue.top();
      if (cell == end) return;
      queue.pop();
      if ((taken & 0xffff) == 0) stop_if_cancelled();
      expand(cell, queue);
    }
  }

  std::vector<float> cost;
  std::vector<std::uint32_t> before;

 private:
  void expand(std::size_t cell, NearestFirst& queue) {
    const int column = int(cell % std::size_t(cells_.columns)), row = int(cell / std::size_t(cells_.columns));
    for (const LineStep& step : steps_) {
      const int x = column + step.column, y = row + step.row;
      if (x < 0 || y < 0 || x >= cells_.columns || y >= cells_.rows) continue;
      const std::size_t to = std::size_t(std::ptrdiff_t(cell) + step.offset);
      if (!passable_[to] || cost[to] <= cost[cell]) continue;
      const float sum = cost_over(step, cell, cost[to]);
      if (!(sum < cost[to])) continue;
      cost[to] = sum;
      before[to] = std::uint32_t(cell);
      queue.push(to);
    }
  }

  /// Cost of the way to `cell` and the step. Gives up once that is no less than `known`.
  float cost_over(const LineStep& step, std::size_t cell, float known) const {
    for (int k = 0; k < step.corners; ++k)
      if (!passable_[std::size_t(std::ptrdiff_t(cell) + step.corner[std::size_t(k)])]) return kImpassable;
    return step.add_cost(cells_, costs_, cell, cost[cell], known);
  }

  const RouteCells& cells_;
  const RouteCosts& costs_;
  std::vector<LineStep> steps_;
  std::vector<char> passable_;  // in some heading
};

}  // namespace

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
  std::vector<std::uint32_t> way;
  {
    Search search(cells, costs, false);
    search.run(start, end);
    if (!std::isfinite(search.cost[end])) return std::nullopt;
    for (std::uint32_t cell = end;; cell = search.before[cell]) {
      way.push_back(cell);
      if (cell == start) break;
    }
  }
  std::reverse(way.begin(), way.end());
  return pull_taut(cells, costs, way);
}

std::vector<float> reach_any_angle(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start,
                                   bool backwards) {
  Search search(cells, costs, backwards);
  search.run(start, kAnywhere);
  return std::move(search.cost);
}

}  // namespace gonogo::map
