#include "pipeline/map/block.h"

#include <omp.h>

#include <cmath>
#include <limits>

#include "terrain/raster/slope.h"

namespace gonogo::pipeline {

using terrain::MapGrid;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
using terrain::Window;
namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();

/// Position of a cell's soil in the table, or -1 when the raster does not say or the table does not list it.
int soil_of(const SoilTable& table, const Tile* codes, int column, int row) {
  if (!codes) return 0;
  const float code = codes->at(column, row);
  if (std::isnan(code)) return -1;
  const auto found = table.index_of_code.find(int(code));
  return found == table.index_of_code.end() || float(found->first) != code ? -1 : found->second;
}

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

}  // namespace

MapSources open_sources(const Region& region) {
  MapSources sources{RasterSource::open_elevation(region.elevation.file), std::nullopt};
  if (region.soil_class)
    sources.soil_class =
        RasterSource::open_on_grid(region.soil_class->file, sources.elevation.grid(), RasterKind::classes);
  return sources;
}

double gradient_error(const RegionRaster& elevation, const MapGrid& grid) {
  const double cell = std::sqrt(grid.cell_area_m2());
  return elevation.error * std::sqrt(1 - elevation.error_correlation) * std::sqrt(12.0) / (8 * cell);
}

SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double error_of_gradient) {
  SoilTable table;
  table.soils = region.soils;
  if (table.soils.empty())
    table.soils.push_back({.code = 0, .name = "all soils", .note = "", .samples = {}, .values = {}});
  for (const Soil& soil : table.soils) {
    table.index_of_code[soil.code] = int(table.responses.size());
    table.responses.emplace_back(model, rules, soil_points(region, soil, rules.values, rules.draws), error_of_gradient);
  }
  table.cells.assign(table.soils.size(), 0);
  return table;
}

BlockLayers evaluate_block(const MapSources& sources, const SoilTable& table, const std::vector<MapLayer>& layers,
                           const MapRules& rules, Window window, int threads) {
  const MapGrid& grid = sources.elevation.grid();
  const Tile bordered =
      sources.elevation.read({window.column - 1, window.row - 1, window.columns + 2, window.rows + 2});
  std::optional<Tile> codes;
  if (sources.soil_class) codes = sources.soil_class->read(window);
  const terrain::CellSize cell = {grid.cell_width_m(), grid.cell_height_m()};
  const Tile empty(window.columns, window.rows, kNoData);
  BlockLayers block{window,
                    empty,
                    terrain::slope_degrees(bordered, cell, threads),
                    terrain::aspect_degrees(bordered, cell, threads),
                    terrain::hillshade(bordered, cell, 315, 45, threads),
                    empty,
                    std::vector<Tile>(layers.size(), empty)};
  const int thread_count = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel for schedule(static) num_threads(thread_count)
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column) {
      block.elevation.at(column, row) = bordered.at(column + 1, row + 1);
      const float slope = block.slope.at(column, row);
      if (std::isnan(slope)) continue;
      const int soil = soil_of(table, codes ? &*codes : nullptr, column, row);
      block.soil.at(column, row) = float(soil);
      CellState state{{Verdict::unknown, Reason::input_missing}, kNoData, nullptr};
      if (soil >= 0) state = in_heading(table.responses[std::size_t(soil)], rules, slope, block.aspect.at(column, row));
      for (std::size_t l = 0; l < layers.size(); ++l) block.layer[l].at(column, row) = layers[l].value(state);
    }
  return block;
}

}  // namespace gonogo::pipeline
