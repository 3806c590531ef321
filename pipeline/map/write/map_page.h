// The data in the page of a map: slope, aspect, elevation and soil of every cell, and the tables of every soil. From
// these the page computes every layer for any heading and threshold. Its code is in pipeline/map/page.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/page/page.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// Max cells in a page. From a larger map every step-th cell in both directions is taken, and the page says so.
inline constexpr int kPageCells = 1'100'000;

/// Inputs of the page's cells.
struct PageCells {
  int step = 1, columns = 0, rows = 0;
  std::vector<float> slope, aspect, elevation;  // [columns * rows]; kNoData: no slope
  std::vector<CellMark> mark;                   // [columns * rows]

  /// Sizes for a page of this grid; the arrays are filled by add_digest().
  explicit PageCells(const terrain::MapGrid& grid);
};

/// Writes the page to `path` as one HTML file.
void write_map_page(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                    const MapSummary& summary, const PageCells& cells, const Metadata& metadata,
                    const std::filesystem::path& path);

}  // namespace gonogo::map
