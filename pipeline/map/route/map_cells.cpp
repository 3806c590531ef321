#include "pipeline/map/route/map_cells.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "base/cancel.h"
#include "base/error.h"
#include "base/first_error.h"

namespace gonogo::map {
namespace {

constexpr int kBandRows = 128;

void take(const TileLayers& tile, const std::vector<LandRule>& land, RouteCells& cells) {
  for (int row = 0; row < tile.window.rows; ++row)
    for (int column = 0; column < tile.window.columns; ++column) {
      const float slope = tile.slope.at(column, row), aspect = tile.aspect.at(column, row);
      const float soil = tile.soil.at(column, row);
      const auto rule = std::size_t(tile.rule.at(column, row));
      const std::size_t i = std::size_t(tile.window.row + row) * std::size_t(cells.columns) + std::size_t(column);
      if (rule > 0 && land[rule - 1].verdict == campaign::Verdict::no_go) cells.soil[i] = RouteCells::kClosed;
      if (std::isnan(soil) || soil < 0 || rule > 0) continue;
      cells.slope[i] = std::uint16_t(std::lround(slope * kSlopeSteps));
      cells.aspect[i] = std::isnan(aspect) ? 0 : std::uint16_t(rounded_aspect(aspect));
      cells.soil[i] = std::uint8_t(soil);
    }
}

}  // namespace

RouteCells read_route_cells(const MapSources& sources, const Region& region, const SoilTable& table,
                            const MapRules& rules, int threads) {
  const terrain::MapGrid& grid = sources.elevation.grid();
  if (table.soils.size() >= RouteCells::kClosed)
    throw InputError("route: the region lists " + std::to_string(table.soils.size()) +
                     " soils; at most 253 can be used");
  RouteCells cells;
  cells.columns = grid.columns;
  cells.rows = grid.rows;
  cells.cell_width = grid.cell_width_m();
  cells.cell_height = grid.cell_height_m();
  const std::size_t count = std::size_t(grid.columns) * std::size_t(grid.rows);
  cells.slope.assign(count, 0);
  cells.aspect.assign(count, 0);
  cells.soil.assign(count, RouteCells::kNowhere);
  const int bands = (grid.rows + kBandRows - 1) / kBandRows;
  const std::vector<LandRule> land = land_rules(region);
  FirstError error;
#pragma omp parallel num_threads(threads > 0 ? threads : omp_get_max_threads())
  {
    std::optional<MapSources> own;
#pragma omp for schedule(dynamic, 1)
    for (int band = 0; band < bands; ++band)
      error.guard([&] {
        stop_if_cancelled();
        if (!own) own = sources.again();
        const int row = band * kBandRows;
        take(
            evaluate_tile(*own, region, table, {}, rules, {0, row, grid.columns, std::min(kBandRows, grid.rows - row)}),
            land, cells);
      });
  }
  error.rethrow();
  return cells;
}

}  // namespace gonogo::map
