// Made ground for tests of routes: two soils whose P(go) is a formula of the slopes, and cells of them.
#pragma once
#include <cmath>

#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/map/route/search/cost.h"
#include "tests/pipeline/map/analytic_model.h"

namespace gonogo::test {

using namespace gonogo::campaign;
using namespace gonogo::map;

inline std::size_t index(const char* name) { return contract().variable_index(name); }

inline double made_p_go(double along, double across) { return 1 / (1 + std::exp((along + std::abs(across) - 16) / 3)); }

/// A soil for each friction angle [deg]; those below 35 are weaker.
inline SoilTable made_table(const std::vector<double>& angles = {35, 31}) {
  OutcomeModel model = AnalyticModel{}.outcome_model();
  model.sampled[index("slope_along")] = {-20, 30};
  model.sampled[index("slope_across")] = {-20, 20};
  model.probabilities = [](std::span<const double> points, std::span<double> result) {
    const std::size_t width = contract().variables.size(), outcomes = contract().outcomes.size();
    std::fill(result.begin(), result.end(), 0.0);
    for (std::size_t i = 0; i * width < points.size(); ++i) {
      const double weaker = 35 - points[i * width + index("friction_angle")];
      const double p =
          made_p_go(points[i * width + index("slope_along")] + weaker, points[i * width + index("slope_across")]);
      result[i * outcomes + contract().outcome_index(Verdict::go, Reason::none)] = p;
      result[i * outcomes + contract().outcome_index(Verdict::no_go, Reason::traction)] = 1 - p;
    }
  };
  SoilTable table;
  for (const double angle : angles) {
    std::vector<double> point(contract().variables.size(), NAN);
    point[index("friction_angle")] = angle;
    table.responses.emplace_back(model, MapRules{}, std::vector<std::vector<double>>{point});
  }
  return table;
}

/// P(go) from the formula at slopes rounded as heading tables round them; 0 where it was not sampled.
inline double made_p_go_at(const RouteCells& cells, std::size_t cell, double psi, double& along) {
  const BedSlopes slopes = bed_slopes(cells.slope[cell] / kSlopeSteps, psi);
  along = std::round(2 * slopes.along) / 2;
  const double across = std::round(2 * slopes.across) / 2;
  if (along < -20 || along > 30 || std::abs(across) > 20) return 0;
  return made_p_go(along + (cells.soil[cell] == 1 ? 4 : 0), across);
}

/// Cost per metre of map distance from the formulas, without the tables of pipeline/map/route; infinity where the
/// heading [deg] cannot be passed. Length or risk.
inline double made_per_metre(const RouteCells& cells, std::size_t cell, double heading, RouteCost cost) {
  if (cells.soil[cell] == RouteCells::kNowhere) return INFINITY;
  double along = 0;
  const double p = made_p_go_at(cells, cell, fall_line_angle(heading, double(cells.aspect[cell])), along);
  if (p < 0.5) return INFINITY;
  const double length = 1 / std::cos(to_radians(along));
  return cost == RouteCost::length ? length : -std::log(p) * length / 100;
}

/// Whether one of 36 headings passes.
inline bool made_passable(const RouteCells& cells, std::size_t cell) {
  if (cells.soil[cell] == RouteCells::kNowhere) return false;
  double along = 0;
  for (int h = 0; h < 36; ++h)
    if (made_p_go_at(cells, cell, h * kPi / 18, along) >= 0.5) return true;
  return false;
}

inline RouteCells made_cells(int columns, int rows, std::uint64_t seed) {
  RouteCells cells{
      .columns = columns, .rows = rows, .cell_width = 10, .cell_height = 12, .slope = {}, .aspect = {}, .soil = {}};
  for (std::uint64_t i = 0; i < std::uint64_t(columns) * std::uint64_t(rows); ++i) {
    const double u = random_unit(seed, 0, i);
    cells.slope.push_back(std::uint16_t(std::lround(13 * random_unit(seed, 1, i) * kSlopeSteps)));
    cells.aspect.push_back(std::uint16_t(random_bits(seed, 2, i) % 360));
    cells.soil.push_back(u < 0.1 ? RouteCells::kNowhere : u < 0.6 ? 0 : 1);
  }
  return cells;
}

/// A third of the slope, and soil everywhere.
inline RouteCells gentle_cells(int columns, int rows, std::uint64_t seed) {
  RouteCells cells = made_cells(columns, rows, seed);
  for (auto& slope : cells.slope) slope = std::uint16_t(slope / 3);
  for (auto& soil : cells.soil)
    if (soil == RouteCells::kNowhere) soil = 0;
  return cells;
}

/// Level cells of 10 m, all of soil 0.
inline RouteCells level_cells(int columns, int rows) {
  const auto count = std::size_t(columns) * std::size_t(rows);
  return {.columns = columns,
          .rows = rows,
          .cell_width = 10,
          .cell_height = 10,
          .slope = std::vector<std::uint16_t>(count, 0),
          .aspect = std::vector<std::uint16_t>(count, 0),
          .soil = std::vector<std::uint8_t>(count, 0)};
}

}  // namespace gonogo::test
