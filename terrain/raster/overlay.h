// A class layer for programs that are no GIS: a picture over the globe.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// West, south, east, north [deg, WGS 84]; over the antimeridian east is less than west.
struct DegreeBox {
  double west = 0, south = 0, east = 0, north = 0;
};
DegreeBox degree_box(const MapGrid& grid);
/// Corners [longitude, latitude], counter-clockwise from the south-west.
std::array<std::array<double, 2>, 4> degree_corners(const MapGrid& grid);

/// A class layer warped to longitude and latitude as `overlay.png`-like picture with transparent nodata, at most
/// `longest` pixels a side, and the KML beside it that lays it over the globe. Texts are escaped.
void write_overlay(const std::filesystem::path& kml, const std::filesystem::path& png,
                   const std::filesystem::path& layer, const std::string& title, const std::string& description,
                   const std::vector<LegendEntry>& legend, int longest = 2048);

/// Text that XML shows as it is; control characters, which XML has no place for, become spaces.
std::string xml_escaped(const std::string& text);

}  // namespace gonogo::terrain
