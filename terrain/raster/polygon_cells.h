// Cells under drawn polygons.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// 1 for each cell that a polygon of the file touches, 0 elsewhere [cell]. Any vector format that GDAL reads, in any
/// coordinate system. Throws InputError: no such file, no vector file, no coordinate system, other shapes than
/// polygons, no polygon on the grid.
std::vector<std::uint8_t> cells_under(const std::filesystem::path& file, const MapGrid& grid);

}  // namespace gonogo::terrain
