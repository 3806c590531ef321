#include "pipeline/map/evaluate/cell.h"

#include <cmath>

#include "terrain/raster/layer/slope.h"

namespace gonogo::map {

using terrain::Tile;
using terrain::Window;
namespace {

CellState in_heading(const SoilResponse& soil, const MapRules& rules, float slope, float aspect) {
  const CellAnswer& answer = soil.at(slope);
  switch (rules.heading_mode) {
    case HeadingMode::worst:
      return {answer.headings.worst, answer.headings.p_worst, &answer};
    case HeadingMode::best:
      return {answer.headings.best, answer.headings.p_best, &answer};
    case HeadingMode::set: {
      const double falls_towards = std::isnan(aspect) ? 0 : rounded_aspect(aspect);
      const HeadingAnswer& set = soil.at(slope, fall_line_angle(rules.heading, falls_towards));
      return {set.result, set.p_go, &answer};
    }
    default:
      return {answer.result, answer.p_go, &answer};
  }
}

/// What the map says about a cell. A land rule wins over the soil.
CellState state_of(const SoilTable& table, const std::vector<LandRule>& land, const MapRules& rules,
                   const CellInputs& cell, float slope, float aspect) {
  if (cell.rule) return {{*land[*cell.rule].verdict, land[*cell.rule].reason}, kNoData, nullptr};
  if (!cell.soil) return {{campaign::Verdict::unknown, campaign::Reason::input_missing}, kNoData, nullptr};
  CellState state = in_heading(table.responses[*cell.soil], rules, slope, aspect);
  const bool unknown = state.result.verdict == campaign::Verdict::unknown;
  if (unknown && !table.soils[*cell.soil].given) state.result.reason = campaign::Reason::input_missing;
  return state;
}

/// Measured in the cell [Pa]; nothing where none was.
std::optional<double> cone_index(const Region& region, const Readings& readings, std::size_t cell) {
  if (region.cone_index_everywhere) return region.cone_index_everywhere;
  const auto counts = readings.cone_index(cell);
  return counts ? std::optional(*counts * region.cone_index->unit) : std::nullopt;
}

CellMark mark_from(const CellInputs& cell) {
  return {.ground = cell.soil ? CellMark::Ground::known_soil : CellMark::Ground::unknown_soil,
          .soil = std::uint16_t(cell.soil.value_or(0)),
          .rule = cell.rule ? std::uint16_t(*cell.rule) : CellMark::kNoRule};
}

}  // namespace

CellInputs decide(const Region& region, const MapRules& rules, const SoilTable& table, const Readings& readings,
                  std::size_t cell) {
  const int state = readings.moisture_state(region, rules, cell);
  const ObstacleMark obstacle = readings.obstacle(cell);
  if (obstacle.kind == ObstacleMark::Kind::road) return {table.find(int(obstacle.index), state), {}, {}};
  const auto code = readings.soil_code(cell);
  CellInputs inputs{code ? table.find(*code, state) : std::nullopt, readings.land_rule(region, cell), {}};
  if (obstacle.kind == ObstacleMark::Kind::rule) inputs.rule = obstacle.index;
  if (obstacle.kind == ObstacleMark::Kind::ditch) inputs.ditch = obstacle.index;
  const std::optional<double> measured = cone_index(region, readings, cell);
  if (!measured || !inputs.soil || inputs.rule || !table.may_be_soft[*inputs.soil]) return inputs;
  const double index = *measured;
  if (index < table.need.one_pass)
    inputs.rule = below_one_pass_rule(region);
  else
    inputs.soil = table.find(table.soils[*inputs.soil].code, state,
                             index < table.need.fifty_passes ? Measured::soft : Measured::firm);
  return inputs;
}

TileLayers::TileLayers(Window window_, std::size_t layers)
    : window(window_),
      elevation(window_.columns, window_.rows, kNoData),
      slope(elevation),
      aspect(elevation),
      shade(elevation),
      mark(elevation.value.size()),
      result(elevation.value.size()),
      p_go(elevation),
      layer(layers, elevation) {}

TileLayers evaluate_tile(const MapSources& sources, const Region& region, const SoilTable& table,
                         const std::vector<MapLayer>& layers, const MapRules& rules, Window window) {
  const terrain::MapGrid& grid = sources.elevation.grid();
  const Tile bordered =
      sources.elevation.read({window.column - 1, window.row - 1, window.columns + 2, window.rows + 2});
  const Readings readings(sources, window);
  const std::vector<LandRule> land = land_rules(region);
  const terrain::CellSize size = {grid.cell_width_m(), grid.cell_height_m()};
  TileLayers tile(window, layers.size());
  tile.slope = terrain::slope_degrees(bordered, size, 1);
  tile.aspect = terrain::aspect_degrees(bordered, size, 1);
  tile.shade = terrain::hillshade(bordered, size, 315, 45, 1);
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column) {
      tile.elevation.at(column, row) = bordered.at(column + 1, row + 1);
      const float slope = tile.slope.at(column, row);
      if (!has_data(slope)) continue;
      const std::size_t i = std::size_t(row) * std::size_t(window.columns) + std::size_t(column);
      CellInputs cell = decide(region, rules, table, readings, i);
      if (cell.soil && cell.ditch && !cell.rule) cell.soil = table.find_ditch(*cell.soil, *cell.ditch);
      const CellState state = state_of(table, land, rules, cell, slope, tile.aspect.value[i]);
      tile.mark[i] = mark_from(cell);
      tile.result[i] = state.result;
      tile.p_go.value[i] = state.p_go;
      for (std::size_t l = 0; l < layers.size(); ++l) tile.layer[l].value[i] = layers[l].value(state);
    }
  return tile;
}

}  // namespace gonogo::map
