// Ways that count their turns against Boost's Dijkstra over (cell, direction), closed forms, and what must hold when
// turns get dearer.
#include "pipeline/map/route/search/turning.h"

#include <algorithm>
#include <array>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <cmath>
#include <ctime>
#include <numeric>

#include "pipeline/map/route/search/any_angle.h"
#include "tests/pipeline/map/made_ground.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::map;
using test::gentle_cells;
using test::level_cells;
using test::made_cells;
using test::made_per_metre;
using test::made_table;

namespace {

using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property,
                                    boost::property<boost::edge_weight_t, double>>;

struct Direction {
  int dx, dy, heading;
};

/// Columns and rows of at most three without a common divisor, clockwise from north.
std::vector<Direction> directions_of(const RouteCells& cells) {
  std::vector<Direction> list;
  for (int dy = -3; dy <= 3; ++dy)
    for (int dx = -3; dx <= 3; ++dx) {
      if (std::gcd(dx, dy) != 1) continue;
      const double angle = std::atan2(dx * cells.cell_width, -dy * cells.cell_height) / kDegree;
      list.push_back({dx, dy, (int(std::lround(angle)) + 360) % 360});
    }
  std::sort(list.begin(), list.end(), [](auto& a, auto& b) { return a.heading < b.heading; });
  return list;
}

std::size_t cell_of(const RouteCells& cells, int x, int y) {
  return std::size_t(y) * std::size_t(cells.columns) + std::size_t(x);
}

/// Cost of a straight step: between crossings of the grid's lines, the cell in the middle of the piece counts.
double step_cost(const RouteCells& cells, int x, int y, const Direction& d, RouteCost cost) {
  if (x + d.dx < 0 || y + d.dy < 0 || x + d.dx >= cells.columns || y + d.dy >= cells.rows) return INFINITY;
  const auto cell_at = [&](double px, double py) { return cell_of(cells, int(std::lround(px)), int(std::lround(py))); };
  std::vector<double> t = {0, 1};
  for (int k = 0; k < std::abs(d.dx); ++k) t.push_back((k + 0.5) / std::abs(d.dx));
  for (int k = 0; k < std::abs(d.dy); ++k) t.push_back((k + 0.5) / std::abs(d.dy));
  std::sort(t.begin(), t.end());
  const double length = std::hypot(d.dx * cells.cell_width, d.dy * cells.cell_height);
  double sum = 0;
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    if (t[k + 1] - t[k] < 1e-9) {  // a corner: both cells beside it must pass in some heading
      const double cx = x + t[k] * d.dx, cy = y + t[k] * d.dy, e = 0.25;
      if (!test::made_passable(cells, cell_at(cx + e * d.dx / std::abs(d.dx), cy - e * d.dy / std::abs(d.dy))) ||
          !test::made_passable(cells, cell_at(cx - e * d.dx / std::abs(d.dx), cy + e * d.dy / std::abs(d.dy))))
        return INFINITY;
      continue;
    }
    const double middle = (t[k] + t[k + 1]) / 2;
    sum += length * (t[k + 1] - t[k]) *
           made_per_metre(cells, cell_at(x + middle * d.dx, y + middle * d.dy), d.heading, cost);
  }
  return sum;
}

/// Least costs over `stops` by an explicit graph of (leg, cell, direction).
double dijkstra(const RouteCells& cells, const std::vector<std::uint32_t>& stops, RouteCost cost, double quarter) {
  const std::vector<Direction> directions = directions_of(cells);
  REQUIRE(directions.size() == 32);
  const std::size_t count = cells.soil.size(), legs = stops.size() - 1, source = legs * count * 32;
  Graph graph(source + 1);
  const auto vertex = [&](std::size_t leg, std::size_t cell, std::size_t d) { return (leg * count + cell) * 32 + d; };
  const auto add = [&](std::size_t from, std::size_t to, double weight) {
    if (std::isfinite(weight)) boost::add_edge(from, to, weight, graph);
  };
  for (std::size_t leg = 0; leg < legs; ++leg)
    for (std::size_t cell = 0; cell < count; ++cell)
      for (std::size_t d = 0; d < 32; ++d) {
        const Direction &here = directions[d], &next = directions[(d + 1) % 32];
        const double turn =
            quarter / 90 * ((next.heading - here.heading + 360) % 360) *
            (made_per_metre(cells, cell, here.heading, cost) + made_per_metre(cells, cell, next.heading, cost)) / 2;
        add(vertex(leg, cell, d), vertex(leg, cell, (d + 1) % 32), turn);
        add(vertex(leg, cell, (d + 1) % 32), vertex(leg, cell, d), turn);
        const int x = int(cell) % cells.columns, y = int(cell) / cells.columns;
        const double driven = step_cost(cells, x, y, here, cost);
        if (std::isfinite(driven))
          add(vertex(leg, cell, d), vertex(leg, cell_of(cells, x + here.dx, y + here.dy), d), driven);
        if (leg + 1 < legs && cell == stops[leg + 1]) add(vertex(leg, cell, d), vertex(leg + 1, cell, d), 0);
        if (leg == 0 && cell == stops[0]) add(source, vertex(0, cell, d), 0);
      }
  std::vector<double> least(source + 1, INFINITY);
  boost::dijkstra_shortest_paths(graph, source, boost::distance_map(least.data()).distance_inf(INFINITY));
  double best = INFINITY;
  for (std::size_t d = 0; d < 32; ++d) best = std::min(best, least[vertex(legs - 1, stops.back(), d)]);
  return best;
}

void block(RouteCells& cells, int left, int top, int right, int bottom) {
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) cells.soil[cell_of(cells, x, y)] = RouteCells::kNowhere;
}

}  // namespace

TEST_CASE("ways with turns cost what Dijkstra's search over cells and directions finds, over stops too") {
  const SoilTable table = made_table();
  int found = 0, none = 0, straightened = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const RouteCells cells = made_cells(11, 9, seed);
    for (const RouteCost cost : {RouteCost::length, RouteCost::risk})
      for (const double quarter : {3.0, 40.0}) {
        const RouteCosts costs(table, cost, 100);
        const Turning turning(cells, costs, quarter);
        for (std::uint64_t k = 0; k < 8; ++k) {
          std::vector<std::uint32_t> stops;
          for (std::uint64_t s = 0; s < 2 + k % 2; ++s)
            stops.push_back(std::uint32_t(random_bits(seed, 20 + s, k) % cells.soil.size()));
          if (std::adjacent_find(stops.begin(), stops.end()) != stops.end()) continue;
          const double expected = dijkstra(cells, stops, cost, quarter);
          const auto way = search_turning(cells, costs, turning, stops);
          INFO("seed " << seed << ", stops " << stops[0] << " to " << stops.back() << ", quarter " << quarter);
          REQUIRE(bool(way) == std::isfinite(expected));
          none += !way;
          if (!way) continue;
          ++found;
          CHECK(way->cost == Approx(expected).epsilon(1e-4).margin(1e-6));
          CHECK(cost_with_turns(cells, costs, turning, way->cell) == Approx(expected).epsilon(1e-4).margin(1e-6));
          const auto taut = find_turning(cells, costs, turning, stops);
          REQUIRE(taut);
          CHECK(taut->cost <= expected * (1 + 1e-4) + 1e-6);
          CHECK(taut->cost == Approx(cost_with_turns(cells, costs, turning, taut->cell)));
          straightened += taut->cost < 0.999 * expected;
          auto at = taut->cell.begin();
          for (const std::uint32_t stop : stops) {
            at = std::find(at, taut->cell.end(), stop);
            REQUIRE(at != taut->cell.end());
          }
        }
      }
  }
  CHECK(found > 40);
  CHECK(none > 5);
  CHECK(straightened > 5);
}

TEST_CASE("a corridor with two bends costs its length and two quarter turns") {
  const SoilTable table = made_table();
  RouteCells cells = level_cells(12, 9);
  block(cells, 0, 0, 11, 8);
  for (int x = 1; x <= 10; ++x) cells.soil[cell_of(cells, x, 1)] = cells.soil[cell_of(cells, x, 7)] = 0;
  for (int y = 1; y <= 7; ++y) cells.soil[cell_of(cells, 10, y)] = 0;
  const RouteCosts costs(table, RouteCost::length, 100);
  for (const double quarter : {1.0, 25.0}) {
    const auto way = find_turning(cells, costs, Turning(cells, costs, quarter), {12 + 1, 7 * 12 + 1});
    REQUIRE(way);
    CHECK(way->cost == Approx(90 + 60 + 90 + 2 * quarter).epsilon(1e-6));
    CHECK(way->cell == std::vector<std::uint32_t>{13, 22, 94, 85});
    CHECK(Turning(cells, costs, quarter).turns(way->cell).degrees == 180);
  }
}

TEST_CASE("a turn takes the side whose headings all pass") {
  const SoilTable table = made_table();
  RouteCells cells = level_cells(1, 1);
  cells.slope[0] = 18 * 64;  // uphill and along the slope are no-go
  const RouteCosts costs(table, RouteCost::length, 100);
  const Turning turning(cells, costs, 10);
  cells.aspect[0] = 180;
  CHECK(turning.turn(0, 105, 255).degrees == 150);
  CHECK(turning.turn(0, 255, 105).degrees == 150);
  cells.aspect[0] = 0;                                         // the way through the south leads uphill
  CHECK_FALSE(std::isfinite(turning.turn(0, 105, 255).cost));  // and these two headings themselves do
  CHECK(turning.turn(0, 75, 285).degrees == 150);
  CHECK(turning.turn(0, 300, 60).degrees == 120);
  CHECK_FALSE(std::isfinite(turning.turn(0, 75, 180).cost));
  cells.slope[0] = 0;
  CHECK(turning.turn(0, 75, 285).cost == Approx(10.0 / 90 * 150));
  CHECK(turning.turn(0, 10, 350).degrees == 20);
  for (int from = 0; from < 360; from += 7)
    for (int to = 0; to < 360; ++to) {
      const int angle = std::min((to - from + 360) % 360, (from - to + 360) % 360);
      const Turn turn = turning.turn(0, from, to);
      REQUIRE(turn.degrees == angle);
      REQUIRE(turn.cost == Approx(10.0 / 90 * angle));
    }
}

TEST_CASE("the dearer turns are, the less a way turns and the more else it costs") {
  const SoilTable table = made_table();
  int fewer = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    RouteCells cells = made_cells(60, 50, seed);
    for (auto& slope : cells.slope) slope = std::uint16_t(slope * 2 / 3);
    const RouteCosts costs(table, RouteCost::risk, 100);
    std::uint32_t start = 0, end = std::uint32_t(cells.soil.size() - 1);
    while (!costs.ever_passable(cells, start)) ++start;
    while (!costs.ever_passable(cells, end)) --end;
    double turned = INFINITY, driven = 0;
    for (const double quarter : {0.5, 5.0, 50.0}) {
      const Turning turning(cells, costs, quarter);
      const auto way = search_turning(cells, costs, turning, {start, end});
      REQUIRE(way);
      const double turns = turning.turns(way->cell).cost / quarter, rest = way->cost - turns * quarter;
      CHECK(turns <= turned * (1 + 1e-4));
      CHECK(rest >= driven * (1 - 1e-4));
      fewer += turns < 0.9 * turned;
      turned = turns;
      driven = rest;
    }
  }
  CHECK(fewer > 4);
}

TEST_CASE("over open ground a way with turns is straight, and around obstacles it beats the one without") {
  const SoilTable table = made_table();
  RouteCells cells = level_cells(80, 70);
  const RouteCosts costs(table, RouteCost::length, 100);
  const Turning turning(cells, costs, 100);
  const auto straight = find_turning(cells, costs, turning, {0, 43 * 80 + 71});
  REQUIRE(straight);
  CHECK(straight->cell.size() == 2);
  CHECK(straight->cost == Approx(10 * std::hypot(71, 43)).epsilon(1e-6));
  CHECK(find_turning(cells, costs, turning, {5, 5})->cost == 0);
  double gain = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    RouteCells field = cells;
    for (std::uint64_t k = 0; k < 60; ++k) {
      const int x = int(random_bits(seed, 1, k) % 70), y = int(random_bits(seed, 2, k) % 60);
      if (x + y > 12 && x + y < 118) block(field, x, y, x + 5, y + 5);
    }
    const auto counted = find_turning(field, costs, turning, {0, 80 * 70 - 1});
    const auto plain = find_any_angle(field, costs, 0, 80 * 70 - 1);
    REQUIRE(bool(counted) == bool(plain));
    if (!plain) continue;
    const double other = cost_with_turns(field, costs, turning, plain->cell);
    CHECK(counted->cost <= other * (1 + 1e-9));
    gain += 1 - counted->cost / other;
  }
  CHECK(gain > 0.01);
}

// Measured by hand: test_pipeline_route "[.speed]".
TEST_CASE("ways with turns over a million cells", "[.speed]") {
  const auto table = made_table();
  const RouteCells cells = gentle_cells(1000, 1000, 9);
  const RouteCosts costs(table, RouteCost::risk, 100);
  for (const double quarter : {2.0, 10.0, 50.0}) {
    const Turning turning(cells, costs, quarter);
    const std::clock_t begin = std::clock();  // of all threads, so that other work does not count
    const auto way = find_turning(cells, costs, turning, {0, std::uint32_t(cells.soil.size() - 1)});
    const double seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
    REQUIRE(way);
    const auto plain = find_any_angle(cells, costs, 0, std::uint32_t(cells.soil.size() - 1));
    WARN("a quarter turn for " << quarter << " m: " << way->cell.size() << " corners, "
                               << turning.turns(way->cell).degrees << " degrees, cost " << way->cost << ", without "
                               << cost_with_turns(cells, costs, turning, plain->cell) << " and "
                               << turning.turns(plain->cell).degrees << " degrees; " << seconds << " s of CPU time");
    CHECK(seconds < 60);
  }
}
