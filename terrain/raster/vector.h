// Writes lines on the ground as GeoPackage, GeoJSON (RFC 7946: WGS 84) or GPX tracks. The file's extension decides.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

struct LineFeature {
  std::string name, colour;                               // colour "#rrggbb", kept as QGIS style in a GeoPackage
  std::vector<std::array<double, 2>> point;               // in the grid's coordinate system
  std::vector<std::pair<std::string, double>> attribute;  // one column each; not kept in GPX
};

/// Throws InputError for extensions other than .gpkg, .geojson, .json and .gpx, and where a format needs WGS 84 and no
/// way to it is known; DeviceError when writing fails. The
/// file is whole or absent.
void write_lines(const std::filesystem::path& path, const MapGrid& grid, const std::string& layer,
                 const std::vector<LineFeature>& lines);

}  // namespace gonogo::terrain
