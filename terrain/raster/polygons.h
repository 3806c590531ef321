// Polygons of equal class in a GeoPackage, with their QGIS style.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// Writes layer "classes" (code, class, area_km2, cell_m) in the class layer's coordinate system. A layer of more than
/// `max_cells` cells is read from an overview; column cell_m is the cell size used. Throws DeviceError when writing
/// fails. The file is whole or absent.
void write_class_polygons(const std::filesystem::path& path, const std::filesystem::path& layer, const MapGrid& grid,
                          const std::vector<LegendEntry>& legend, double max_cells = 4e6);

/// The same for codes in memory, row by row from the north, as layer `name`. kClassNoData: no polygon.
void write_cell_polygons(const std::filesystem::path& path, const std::string& name, const MapGrid& grid,
                         const std::vector<std::uint8_t>& code, const std::vector<LegendEntry>& legend);

}  // namespace gonogo::terrain
