// What the page of a map holds: the cells' slope, aspect, elevation and soil, and each soil's tables, from which the
// page works out every layer, heading and threshold by itself. The page is pipeline/page.
#pragma once
#include <filesystem>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// Most cells of a page; of a larger map every step-th cell in both directions is taken, and the page says so.
inline constexpr int kPageCells = 1'100'000;

/// Inputs of the page's cells.
struct PageCells {
  int step = 1, columns = 0, rows = 0;
  std::vector<float> slope, aspect, elevation, soil;  // [columns * rows]; not-a-number where there is no slope
  std::vector<float> rule;                            // 0, or 1 + position in land_rules()

  explicit PageCells(const terrain::MapGrid& grid);
};

void write_map_page(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                    const MapSummary& summary, const PageCells& cells, const Metadata& metadata,
                    const std::filesystem::path& path);

}  // namespace gonogo::map
