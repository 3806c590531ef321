// Routes against an independent search that relaxes every step until nothing changes, on small made ground.
#include <chrono>
#include <cmath>
#include <set>

#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/map/route/reach.h"
#include "pipeline/map/route/search/search.h"
#include "tests/pipeline/map/made_ground.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using test::gentle_cells;
using test::index;
using test::made_cells;
using test::made_table;

namespace {

/// Cost of half a step from the formulas, without the tables of pipeline/route; infinity where it cannot be passed.
double half_step(const RouteCells& cells, int cell, int dx, int dy, RouteCost cost) {
  const double heading = std::round(to_degrees(std::atan2(dx * cells.cell_width, -dy * cells.cell_height)));
  return std::hypot(dx * cells.cell_width, dy * cells.cell_height) / 2 *
         test::made_per_metre(cells, std::size_t(cell), heading, cost);
}

bool some_heading_passes(const RouteCells& cells, int cell) { return test::made_passable(cells, std::size_t(cell)); }

/// Bellman-Ford over all steps of all cells.
std::vector<double> relaxed(const RouteCells& cells, int start, RouteCost cost) {
  std::vector<double> best(cells.soil.size(), INFINITY);
  best[std::size_t(start)] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (int y = 0; y < cells.rows; ++y)
      for (int x = 0; x < cells.columns; ++x)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const int nx = x + dx, ny = y + dy, here = y * cells.columns + x, next = ny * cells.columns + nx;
            if ((dx == 0 && dy == 0) || nx < 0 || ny < 0 || nx >= cells.columns || ny >= cells.rows) continue;
            if (!some_heading_passes(cells, next)) continue;
            if (dx != 0 && dy != 0 &&
                (!some_heading_passes(cells, y * cells.columns + nx) ||
                 !some_heading_passes(cells, ny * cells.columns + x)))
              continue;
            const double sum =
                best[std::size_t(here)] + half_step(cells, here, dx, dy, cost) + half_step(cells, next, dx, dy, cost);
            if (sum < best[std::size_t(next)] - 1e-12) {
              best[std::size_t(next)] = sum;
              changed = true;
            }
          }
  }
  return best;
}

}  // namespace

TEST_CASE("costs to every cell equal those of an independent search, and a route adds up to its cost") {
  const SoilTable table = made_table();
  int routes = 0, unreachable = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const RouteCells cells = made_cells(17, 13, seed);
    int start = 0;
    while (!some_heading_passes(cells, start)) ++start;
    for (const RouteCost cost : {RouteCost::length, RouteCost::risk}) {
      const RouteCosts costs(table, cost, 100);
      const std::vector<double> expected = relaxed(cells, start, cost);
      const std::vector<float> found = reach(cells, costs, std::uint32_t(start));
      for (std::size_t c = 0; c < expected.size(); ++c) {
        INFO("seed " << seed << ", cell " << c);
        REQUIRE(std::isfinite(expected[c]) == std::isfinite(found[c]));
        const auto route = find_route(cells, costs, std::uint32_t(start), std::uint32_t(c));
        REQUIRE(bool(route) == std::isfinite(expected[c]));
        unreachable += !route;
        if (!route) continue;
        CHECK(double(found[c]) == Approx(expected[c]).epsilon(1e-4).margin(1e-6));
        double sum = 0;
        for (std::size_t i = 1; i < route->cell.size(); ++i) {
          const int a = int(route->cell[i - 1]), b = int(route->cell[i]);
          const int dx = b % cells.columns - a % cells.columns, dy = b / cells.columns - a / cells.columns;
          sum += half_step(cells, a, dx, dy, cost) + half_step(cells, b, dx, dy, cost);
          REQUIRE(cells.soil[std::size_t(b)] != RouteCells::kNowhere);
        }
        CHECK(sum == Approx(expected[c]).epsilon(1e-4).margin(1e-6));
        ++routes;
      }
    }
  }
  CHECK(routes > 200);
  CHECK(unreachable > 50);
}

TEST_CASE("uphill and downhill cost different things, and reach backwards is reach along the turned way") {
  const SoilTable table = made_table();
  const RouteCells cells = made_cells(12, 9, 5);
  const RouteCosts costs(table, RouteCost::risk, 100);
  std::uint32_t target = 0;
  while (!some_heading_passes(cells, int(target))) ++target;
  const std::vector<float> back = reach(cells, costs, target, true);
  int compared = 0, different = 0;
  for (std::uint32_t c = 0; c < back.size(); ++c) {
    if (!some_heading_passes(cells, int(c))) continue;
    const auto there = find_route(cells, costs, c, target);
    REQUIRE(bool(there) == std::isfinite(back[c]));
    if (!there) continue;
    CHECK(there->cost == Approx(double(back[c])).epsilon(1e-4).margin(1e-6));
    const auto away = find_route(cells, costs, target, c);
    different += !away || std::abs(away->cost - there->cost) > 1e-6;
    ++compared;
  }
  CHECK(compared > 20);
  CHECK(different > 10);
}

TEST_CASE("risk and length of a way do not depend on the size of the cells") {
  const SoilTable table = made_table();
  for (const RouteCost cost : {RouteCost::length, RouteCost::risk}) {
    const RouteCosts costs(table, cost, 100);
    double sums[2];
    for (const int finer : {1, 2}) {
      const int columns = 40 * finer;
      const auto count = std::size_t(columns);
      const RouteCells cells{.columns = columns,
                             .rows = 1,
                             .cell_width = 10.0 / finer,
                             .cell_height = 10.0 / finer,
                             .slope = std::vector<std::uint16_t>(count, 6 * 64),
                             .aspect = std::vector<std::uint16_t>(count, 270),
                             .soil = std::vector<std::uint8_t>(count, 0)};
      // From the middle of the first coarse cell to the middle of the last one.
      const auto route = find_route(cells, costs, 0, std::uint32_t(columns - finer));
      REQUIRE(route);
      sums[finer - 1] = route->cost;
    }
    CHECK(sums[1] == Approx(sums[0]).epsilon(1e-5));
  }
}

TEST_CASE("connected regions are those that a flood along two-way steps fills") {
  const SoilTable table = made_table();
  RouteCells cells{.columns = 9,
                   .rows = 3,
                   .cell_width = 10,
                   .cell_height = 10,
                   .slope = std::vector<std::uint16_t>(27, 0),
                   .aspect = std::vector<std::uint16_t>(27, 0),
                   .soil = std::vector<std::uint8_t>(27, 0)};
  for (std::size_t row = 0; row < 3; ++row) cells.soil[9 * row + 4] = RouteCells::kNowhere;
  const auto region = connected_regions(cells, RouteCosts(table, RouteCost::length, 100));
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 9; ++column)
      CHECK(region[9 * row + column] == (column < 4 ? 0 : column == 4 ? -1 : 1));
}

TEST_CASE("bands of equal cost have round widths, labels in readable units, and hold every cell that is reached") {
  std::vector<float> seconds;
  for (int i = 0; i <= 4000; i += 10) seconds.push_back(float(i));
  seconds.push_back(INFINITY);
  const CostBands minutes = cost_bands(RouteCost::time, seconds, 0);
  CHECK(minutes.interval == 600);
  CHECK(minutes.label.size() == 7);
  CHECK(minutes.label[1] == "10 to 20 min");
  for (std::size_t i = 0; i + 1 < seconds.size(); ++i) CHECK(minutes.band[i] == int(i) / 60);
  CHECK(minutes.band.back() == kNoBand);
  CHECK(cost_bands(RouteCost::time, seconds, 45).label[1] == "45 to 90 s");
  CHECK(cost_bands(RouteCost::length, seconds, 0).label[1] == "0.5 to 1 km");
  CHECK(cost_bands(RouteCost::energy, {0, 3e6f}, 0).label[1] == "0.5 to 1 MJ");
  CHECK(cost_bands(RouteCost::risk, {0, 0.5f}, 0).label[1] == "risk 0.1 to 0.2");
  CHECK(cost_bands(RouteCost::length, {INFINITY, 0}, 0).label.size() == 1);  // nothing but the start
  CHECK(cost_bands(RouteCost::time, seconds, 16.01).label.size() == 250);
  CHECK(contains(input_error([&] { cost_bands(RouteCost::time, seconds, 15); }), "makes 267 bands"));
  CHECK(contains(input_error([&] { cost_bands(RouteCost::time, seconds, -1); }), "--interval"));
  CHECK(contains(input_error([&] { cost_bands(RouteCost::time, seconds, NAN); }), "--interval"));
}

TEST_CASE("regions are ranked by their size, and those beyond the largest are counted together") {
  std::vector<std::int32_t> region = {-1, 0, 1, 1, 2, 2, 1, 0, 3};
  const LargestRegions few = largest_regions(region);
  CHECK(few.cells == std::vector<std::uint64_t>{3, 2, 2, 1});
  CHECK(few.rank == std::vector<std::uint8_t>{kNoBand, 1, 0, 0, 2, 2, 0, 1, 3});
  for (std::int32_t r = 4; r < 40; ++r) region.push_back(r);
  const LargestRegions many = largest_regions(region);
  CHECK(many.cells.size() == 40);
  CHECK(many.rank.back() == kMaxRegions);
  CHECK(many.rank[8] == 3);
  CHECK(largest_regions({-1, -1}).cells.empty());
}

TEST_CASE("the queue gives cells by cost, and by number where costs are equal, as an ordered set does") {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    constexpr std::uint64_t count = 3000;
    std::vector<float> cost(count, INFINITY);
    NearestFirst queue(cost);
    std::set<std::pair<float, std::size_t>> expected;
    float reached = 0;
    std::uint64_t emptied = 0, cheaper = 0;
    for (std::uint64_t i = 0; i < 20 * count; ++i) {
      const std::size_t cell = random_bits(seed, 0, i) % count;
      // No less than what was taken last, often the same, and in steps of very different sizes.
      const float step = float(random_bits(seed, 1, i) % 4) * std::exp2f(float(random_bits(seed, 2, i) % 24) - 20);
      const bool grows = i / 500 % 2 == 0;
      if (random_unit(seed, 3, i) < (grows ? 0.7 : 0.1) && reached + step < cost[cell]) {
        cheaper += expected.erase({cost[cell], cell});
        cost[cell] = reached + step;
        expected.insert({cost[cell], cell});
        queue.push(cell);
      } else if (!expected.empty()) {
        REQUIRE(!queue.empty());
        REQUIRE(queue.top() == expected.begin()->second);
        queue.pop();
        reached = expected.begin()->first;
        expected.erase(expected.begin());
        emptied += expected.empty();
      }
      REQUIRE(queue.empty() == expected.empty());
    }
    CHECK(emptied > 0);
    CHECK(cheaper > 0);
  }
}

TEST_CASE("a cost that nobody knows, and one that the model cannot tell, are refused") {
  CHECK(contains(input_error([] { route_cost_named("scenic"); }), "use fastest, safest, least-energy or shortest"));
  const SoilTable table = made_table();
  CHECK(contains(input_error([&] { RouteCosts(table, RouteCost::time, 100); }), "--dataset"));
}

// Measured by hand: test_pipeline_route "[.speed]".
TEST_CASE("a route over ten million cells", "[.speed]") {
  const SoilTable table = made_table();
  const RouteCells cells = gentle_cells(3163, 3163, 9);
  const auto begin = std::chrono::steady_clock::now();
  const RouteCosts costs(table, RouteCost::risk, 100);
  const auto route = find_route(cells, costs, 0, std::uint32_t(cells.soil.size() - 1));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  REQUIRE(route);
  WARN(cells.soil.size() << " cells, " << route->cell.size() << " steps, " << seconds << " s");
  CHECK(seconds < 10);
}
