// Looks through an elevation raster for heights that cannot be: undeclared voids, and large areas that are exactly
// flat. Only for the .cpp files of this folder.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {

/// What stored values mean.
struct HeightScale {
  double scale = 1, offset = 0;            // height [m] = scale stored + offset
  double cell_width = 1, cell_height = 1;  // on the ground [m]
  bool on_earth = true;
};

/// A stored value that stands for "no height" without being declared.
struct FoundVoid {
  float value = 0;
  std::uint64_t cells = 0;
};

/// Cells by row: ascending, disjoint runs [begin, end).
using CellRuns = std::vector<std::vector<std::pair<int, int>>>;

struct HeightScan {
  std::vector<FoundVoid> voids;
  CellRuns flat;  // [row]; empty when no area is flat
  int flat_areas = 0;
  std::uint64_t flat_cells = 0;
};

/// Reads all cells once, row by row. Voids are
///   - -9999, and values outside of -11,500 to 9,000 m on the Earth or +-30,000 m elsewhere, if there are at most
///   three;
///   - -999, -99 and 0, if at least half of their borders with other heights are steeper than 60 degrees.
/// Flat are connected areas of one height with at least 400 cells and 1 ha. Where all heights are whole numbers, plains
/// have such areas too; there it takes 1 km2 that hardly borders on anything lower. Fringes less than four cells wide
/// are not counted in. Memory grows with the width of the raster and the flat areas.
/// Throws InputError when more values than three cannot be heights, and for a damaged file.
HeightScan scan_heights(GDALDataset& dataset, const std::string& name, const HeightScale& scale);

}  // namespace gonogo::terrain
