// Evaluates a map in one window and in strips.
#pragma once
#include <cstring>

#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/write/make_map.h"
#include "tests/support/catch.h"

namespace gonogo::test {

/// Checks that strips of so many rows give every layer the same bits as the whole map.
inline void check_strips(const map::MapRequest& request, int strip_rows) {
  const map::MapSources sources = map::open_sources(request.region);
  const map::SoilTable table = map::make_soil_table(request.model, request.region, request.rules, 0, sources);
  const auto layers = map::map_layers(request.rules, request.model, false, {});
  const terrain::MapGrid& grid = sources.elevation.grid();
  const auto evaluate = [&](int row, int rows) {
    return evaluate_tile(sources, request.region, table, layers, request.rules, {0, row, grid.columns, rows});
  };
  const map::TileLayers whole = evaluate(0, grid.rows);
  for (int row = 0; row < grid.rows; row += strip_rows) {
    const map::TileLayers strip = evaluate(row, std::min(strip_rows, grid.rows - row));
    for (std::size_t l = 0; l < layers.size(); ++l) {
      INFO(layers[l].file << " from row " << row);
      const auto& part = strip.layer[l].value;
      const float* all = &whole.layer[l].value[std::size_t(row) * std::size_t(grid.columns)];
      CHECK(std::memcmp(part.data(), all, part.size() * sizeof(float)) == 0);
    }
  }
}

}  // namespace gonogo::test
