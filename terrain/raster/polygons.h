// Cells of equal class as polygons in a GeoPackage, with the style that QGIS draws them in.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// Layer "classes" (code, class, area_km2, cell_m) of a class layer, in its own system. Larger layers are taken at the
/// overview with at most `max_cells` cells, whose size the column cell_m states. Throws DeviceError when writing
/// fails; the file is whole or absent.
void write_class_polygons(const std::filesystem::path& path, const std::filesystem::path& layer, const MapGrid& grid,
                          const std::vector<LegendEntry>& legend, double max_cells = 4e6);

/// The same of codes in memory, row by row from the north, kClassNoData where there is nothing: layer `name`.
void write_cell_polygons(const std::filesystem::path& path, const std::string& name, const MapGrid& grid,
                         const std::vector<std::uint8_t>& code, const std::vector<LegendEntry>& legend);

}  // namespace gonogo::terrain
