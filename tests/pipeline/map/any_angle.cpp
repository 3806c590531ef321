// Ways in any direction against a continuous solver, closed forms around one obstacle, and the search in eight
// directions.
#include "pipeline/map/route/search/any_angle.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/units.h"
#include "tests/pipeline/map/made_ground.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::map;
using test::gentle_cells;
using test::level_cells;
using test::made_cells;
using test::made_table;

namespace {

std::uint32_t cell_at(const RouteCells& cells, int column, int row) {
  return std::uint32_t(row) * std::uint32_t(cells.columns) + std::uint32_t(column);
}

void block(RouteCells& cells, int left, int top, int width, int height, std::uint8_t soil = RouteCells::kNowhere) {
  for (int y = std::max(0, top); y < std::min(cells.rows, top + height); ++y)
    for (int x = std::max(0, left); x < std::min(cells.columns, left + width); ++x)
      cells.soil[cell_at(cells, x, y)] = soil;
}

/// Travel costs from `start` by the eikonal equation |grad u| = f, on cells divided in `finer` x `finer`: fast sweeping
/// with Godunov's upwind differences (Zhao, Math. Comp. 74, 2005). f is the cost per metre of level ground. Around the
/// start, within four cells that must be alike, u is exact.
std::vector<double> eikonal(const RouteCells& cells, const RouteCosts& costs, std::uint32_t start, int finer) {
  const int columns = cells.columns * finer, rows = cells.rows * finer;
  const double h = cells.cell_width / finer;
  const auto coarse = [&](int x, int y) { return cell_at(cells, x / finer, y / finer); };
  const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(columns) + std::size_t(x); };
  std::vector<double> u(at(0, rows), INFINITY), f(u.size());
  std::vector<char> fixed(u.size());
  const int sx = int(start) % cells.columns * finer + finer / 2, sy = int(start) / cells.columns * finer + finer / 2;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) f[at(x, y)] = double(costs.per_metre(cells, coarse(x, y), 0));
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double distance = h * std::hypot(x - sx, y - sy);
      if (distance > 4 * cells.cell_width) continue;
      REQUIRE(f[at(x, y)] == f[at(sx, sy)]);
      u[at(x, y)] = distance * f[at(x, y)];
      fixed[at(x, y)] = 1;
    }
  const auto value = [&](int x, int y) { return x < 0 || y < 0 || x >= columns || y >= rows ? INFINITY : u[at(x, y)]; };
  for (double change = INFINITY; change > 1e-9;) {
    change = 0;
    for (const auto& [right, down] : {std::pair(1, 1), {-1, 1}, {-1, -1}, {1, -1}})
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
          const int x = right > 0 ? i : columns - 1 - i, y = down > 0 ? j : rows - 1 - j;
          const std::size_t c = at(x, y);
          if (fixed[c] || !std::isfinite(f[c])) continue;
          const double a = std::min(value(x - 1, y), value(x + 1, y)), b = std::min(value(x, y - 1), value(x, y + 1));
          if (!std::isfinite(std::min(a, b))) continue;
          const double g = f[c] * h, one_sided = std::min(a, b) + g;
          const double next = std::abs(a - b) < g ? (a + b + std::sqrt(2 * g * g - (a - b) * (a - b))) / 2 : one_sided;
          if (next < u[c] * (1 - 1e-12)) {
            change = std::max(change, std::isfinite(u[c]) ? (u[c] - next) / next : 1);
            u[c] = next;
          }
        }
  }
  std::vector<double> result;
  for (int row = 0; row < cells.rows; ++row)
    for (int column = 0; column < cells.columns; ++column)
      result.push_back(u[at(column * finer + finer / 2, row * finer + finer / 2)]);
  return result;
}

/// Blocks of 4 to 16 cells over a third of the ground, none near the corner of the start.
RouteCells obstacle_field(int side, std::uint64_t seed) {
  RouteCells cells = level_cells(side, side);
  for (std::uint64_t k = 0; k < std::uint64_t(side * side / 260); ++k) {
    const auto draw = [&](std::uint64_t stream, int most) { return int(random_unit(seed, stream, k) * most); };
    const int left = draw(0, side), top = draw(1, side);
    if (left + top > 24) block(cells, left, top, 4 + draw(2, 13), 4 + draw(3, 13));
  }
  block(cells, 0, 0, 11, 11, 0);
  return cells;
}

}  // namespace

TEST_CASE("a line costs what fine samples of it add up to, and corners beside obstacles are closed") {
  const auto table = made_table();
  const RouteCosts costs(table, RouteCost::risk, 100);
  const RouteCells cells = made_cells(40, 30, 4);
  int finite = 0;
  for (std::uint64_t k = 0; k < 400; ++k) {
    const auto from = std::uint32_t(random_bits(1, 0, k) % 1200), to = std::uint32_t(random_bits(1, 1, k) % 1200);
    if (from == to) continue;
    const std::uint32_t from_row = from / 40, to_row = to / 40;
    const double x0 = from % 40 + 0.5, y0 = from_row + 0.5, dx = double(to % 40) - from % 40,
                 dy = double(to_row) - from_row;
    const int heading = (int(std::lround(std::atan2(dx * 10, -dy * 12) / kDegree)) + 360) % 360;
    constexpr int samples = 20011;
    double sum = 0;
    int blocked = 0;
    for (int i = 0; i < samples; ++i) {
      const double t = (i + 0.5) / samples;
      const float cost = costs.per_metre(cells, cell_at(cells, int(x0 + t * dx), int(y0 + t * dy)), heading);
      blocked += !std::isfinite(cost);
      sum += std::isfinite(cost) ? double(cost) / samples : 0;
    }
    if (blocked > 0 && blocked < 4) continue;  // a corner, on whose side a sample falls by rounding
    sum *= std::hypot(dx * 10, dy * 12);
    const double found = line_cost(cells, costs, from, to);
    if (blocked > 0) CHECK(std::isinf(found));
    if (!std::isfinite(found)) continue;
    ++finite;
    CHECK(found == Approx(sum).epsilon(2e-3));
  }
  CHECK(finite > 20);
  RouteCells open = level_cells(4, 4);
  CHECK(line_cost(open, costs, cell_at(open, 0, 0), cell_at(open, 3, 3)) > 0);
  open.soil[cell_at(open, 2, 1)] = RouteCells::kNowhere;
  CHECK(std::isinf(line_cost(open, costs, cell_at(open, 0, 0), cell_at(open, 3, 3))));
}

TEST_CASE("on even ground a way in any direction is the straight line") {
  const auto table = made_table();
  const RouteCosts costs(table, RouteCost::length, 100);
  const RouteCells cells = level_cells(150, 150);
  for (int k = 0; k <= 20; ++k) {
    const std::uint32_t end = cell_at(cells, 140, 7 * k);
    const auto way = find_any_angle(cells, costs, cell_at(cells, 3, 2), end);
    REQUIRE(way);
    CHECK(way->cost == Approx(10 * std::hypot(137, 7 * k - 2)).epsilon(1e-6));
    CHECK(way->cell.size() == 2);
  }
  const std::vector<float> all = reach_any_angle(cells, costs, cell_at(cells, 75, 75));
  double worst = 0;
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 150; ++x)
      if (x != 75 || y != 75)
        worst = std::max(worst, double(all[cell_at(cells, x, y)]) / (10 * std::hypot(x - 75, y - 75)) - 1);
  CHECK(worst < 1 / std::cos(9.2175 * kDegree) - 1 + 1e-4);
  CHECK(worst > 0.012);
}

TEST_CASE("around one obstacle the way is the closed form's: two tangents and an arc, or two lines over a corner") {
  const auto table = made_table();
  const RouteCosts costs(table, RouteCost::length, 100);
  RouteCells disc = level_cells(301, 301);
  constexpr double radius = 80.25;  // [cells], of cells whose centre lies inside
  for (int y = 0; y < 301; ++y)
    for (int x = 0; x < 301; ++x)
      if (std::hypot(x - 150, y - 150) < radius) disc.soil[cell_at(disc, x, y)] = RouteCells::kNowhere;
  const auto around = find_any_angle(disc, costs, cell_at(disc, 10, 150), cell_at(disc, 290, 150));
  REQUIRE(around);
  const double tangent = std::sqrt(140 * 140 - radius * radius), arc = radius * (kPi - 2 * std::acos(radius / 140));
  CHECK(around->cost == Approx(10 * (2 * tangent + arc)).epsilon(0.008));
  CHECK(around->cost > 10 * (2 * tangent + arc) * 0.999);

  RouteCells wall = level_cells(300, 300);
  block(wall, 140, 100, 20, 200);
  const auto over = find_any_angle(wall, costs, cell_at(wall, 60, 250), cell_at(wall, 270, 180));
  REQUIRE(over);
  const double closed = std::hypot(139 - 60, 250 - 99) + 21 + std::hypot(270 - 160, 180 - 99);  // over cells' centres
  CHECK(over->cost == Approx(10 * closed).epsilon(1e-3));
}

TEST_CASE(
    "ways through fields of obstacles are within 1.5 % of a continuous solver's, those in eight directions are not") {
  const auto table = made_table();
  const RouteCosts costs(table, RouteCost::length, 100);
  double worst = 0, least = 1, plain = 0;
  int compared = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const RouteCells cells = obstacle_field(120, seed);
    const std::uint32_t start = cell_at(cells, 5, 5);
    const std::vector<double> exact = eikonal(cells, costs, start, 5);
    for (std::uint64_t k = 0; k < 60; ++k) {
      const auto end = std::uint32_t(random_bits(seed, 9, k) % cells.soil.size());
      if (!std::isfinite(exact[end]) || exact[end] < 300) continue;
      const auto way = find_any_angle(cells, costs, start, end);
      if (!way) continue;  // a gap as narrow as a corner
      worst = std::max(worst, way->cost / exact[end]);
      least = std::min(least, way->cost / exact[end]);
      plain = std::max(plain, find_route(cells, costs, start, end)->cost / exact[end]);
      ++compared;
    }
  }
  CAPTURE(worst, least, plain);
  CHECK(compared > 90);
  CHECK(worst < 1.015);
  CHECK(least > 0.985);  // the solver's own error
  CHECK(plain > 1.04);
  WARN("any direction " << least << " to " << worst << ", eight directions up to " << plain << ", of " << compared);
}

TEST_CASE("a search from both ends finds ways that cost what relaxing every step again and again finds") {
  const auto table = made_table();
  int found = 0, closed = 0;
  for (const std::uint64_t seed : {4u, 5u, 6u, 7u}) {
    const RouteCells cells = made_cells(40, 30, seed);
    const RouteCosts costs(table, seed % 2 ? RouteCost::risk : RouteCost::length, 100);
    const std::vector<LineStep> steps = line_steps(cells, false);
    for (std::uint64_t k = 0; k < 12; ++k) {
      const auto start = std::uint32_t(random_bits(seed, 2, k) % 1200),
                 end = std::uint32_t(random_bits(seed, 3, k) % 1200);
      std::vector<double> least(1200, INFINITY);
      least[start] = 0;
      for (bool changed = true; changed;) {
        changed = false;
        for (std::uint32_t from = 0; from < 1200; ++from)
          for (const LineStep& step : steps) {
            const int x = int(from % 40) + step.column, y = int(from / 40) + step.row;
            if (!std::isfinite(least[from]) || x < 0 || y < 0 || x >= 40 || y >= 30) continue;
            const std::uint32_t to = cell_at(cells, x, y);
            const double sum = least[from] + line_cost(cells, costs, from, to);
            if (sum < least[to] * (1 - 1e-12)) {
              least[to] = sum;
              changed = true;
            }
          }
      }
      for (const std::size_t together : {1, 16, 1 << 16}) {
        const std::vector<std::uint32_t> way = way_in_steps(cells, costs, start, end, together);
        CHECK(way.empty() == std::isinf(least[end]));
        if (way.empty()) continue;
        CHECK((way.front() == start && way.back() == end));
        double sum = 0;
        for (std::size_t i = 1; i < way.size(); ++i) sum += line_cost(cells, costs, way[i - 1], way[i]);
        CHECK(sum == Approx(least[end]).epsilon(1e-5));
      }
      ++(std::isinf(least[end]) ? closed : found);
    }
  }
  CHECK(found > 10);
  CHECK(closed > 2);
}

TEST_CASE("across soils of different cost the way bends as the continuous solver's does") {
  const auto table = made_table();
  const RouteCosts costs(table, RouteCost::risk, 100);
  double worst = 0, least = 1;
  int compared = 0;
  for (const std::uint64_t seed : {5u, 6u}) {
    RouteCells cells = level_cells(120, 120);
    const RouteCells field = obstacle_field(120, seed);
    for (std::size_t c = 0; c < cells.soil.size(); ++c) cells.soil[c] = field.soil[c] == RouteCells::kNowhere ? 1 : 0;
    const std::uint32_t start = cell_at(cells, 5, 5);
    const std::vector<double> exact = eikonal(cells, costs, start, 5);
    for (std::uint64_t k = 0; k < 60; ++k) {
      const auto end = std::uint32_t(random_bits(seed, 9, k) % cells.soil.size());
      const auto way = find_any_angle(cells, costs, start, end);
      REQUIRE(way);
      if (end % 120 + end / 120 < 40) continue;
      worst = std::max(worst, way->cost / exact[end]);
      least = std::min(least, way->cost / exact[end]);
      ++compared;
    }
  }
  CAPTURE(worst, least);
  CHECK(compared > 90);
  CHECK(worst < 1.015);
  CHECK(least > 0.985);
}

TEST_CASE("on rough ground a way in any direction costs no more than one in eight, and adds up line by line") {
  const auto table = made_table();
  int compared = 0;
  double saved = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const RouteCells cells = made_cells(40, 30, seed);
    for (const RouteCost cost : {RouteCost::length, RouteCost::risk}) {
      const RouteCosts costs(table, cost, 100);
      for (std::uint64_t k = 0; k < 40; ++k) {
        const auto start = std::uint32_t(random_bits(seed, 7, k) % 1200),
                   end = std::uint32_t(random_bits(seed, 8, k) % 1200);
        const auto plain = find_route(cells, costs, start, end), any = find_any_angle(cells, costs, start, end);
        if (plain) REQUIRE(any);
        if (!any) continue;
        double sum = 0;
        for (std::size_t i = 1; i < any->cell.size(); ++i)
          sum += line_cost(cells, costs, any->cell[i - 1], any->cell[i]);
        CHECK(any->cost == Approx(sum).margin(1e-9));
        CHECK(any->cell.front() == start);
        CHECK(any->cell.back() == end);
        if (!plain) continue;
        CHECK(any->cost <= plain->cost * (1 + 1e-5) + 1e-9);
        saved += plain->cost > 0 ? 1 - any->cost / plain->cost : 0;
        ++compared;
      }
      const std::uint32_t target = std::uint32_t(random_bits(seed, 3, 0) % 1200);
      const std::vector<float> back = reach_any_angle(cells, costs, target, true);
      for (std::uint32_t c = 0; c < 1200; c += 97) {
        const auto there = find_any_angle(cells, costs, c, target);
        if (costs.ever_passable(cells, c) && costs.ever_passable(cells, target))
          CHECK(bool(there) == std::isfinite(back[c]));
        if (there && std::isfinite(back[c])) CHECK(there->cost <= double(back[c]) * (1 + 1e-5) + 1e-9);
      }
    }
  }
  CHECK(compared > 60);
  CHECK(saved / compared > 0.01);
}

// Measured by hand: test_pipeline_route "[.speed]".
TEST_CASE("a way in any direction over ten million cells", "[.speed]") {
  const auto table = made_table();
  const RouteCells cells = gentle_cells(3163, 3163, 9);
  const RouteCosts costs(table, RouteCost::risk, 100);
  const auto begin = std::chrono::steady_clock::now();
  const auto way = find_any_angle(cells, costs, 0, std::uint32_t(cells.soil.size() - 1));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  REQUIRE(way);
  WARN(cells.soil.size() << " cells, " << way->cell.size() << " corners, " << seconds << " s");
  CHECK(seconds < 15);
}
