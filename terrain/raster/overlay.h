// A class layer as a picture with its place on the globe, for programs that are not GIS.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// Bounds [deg, WGS 84]. Across the antimeridian east is less than west.
struct DegreeBox {
  double west = 0, south = 0, east = 0, north = 0;
};
DegreeBox degree_box(const MapGrid& grid);
/// Corners [longitude, latitude], counter-clockwise from the south-west.
std::array<std::array<double, 2>, 4> degree_corners(const MapGrid& grid);

/// Writes a class layer, warped to longitude and latitude, as a PNG with transparent nodata, at most `longest` pixels a
/// side; and the KML that places it on the globe. Texts are escaped.
void write_overlay(const std::filesystem::path& kml, const std::filesystem::path& png,
                   const std::filesystem::path& layer, const std::string& title, const std::string& description,
                   const std::vector<LegendEntry>& legend, int longest = 2048);

/// Escapes text for XML. Control characters, which XML does not allow, become spaces.
std::string xml_escaped(const std::string& text);

}  // namespace gonogo::terrain
