// Writes lines, polygons and tracks on the ground as files of GIS and navigation programs.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/grid.h"
#include "terrain/raster/layer/geotiff.h"

namespace gonogo::terrain {

struct LineFeature {
  std::string name, colour;                               // colour "#rrggbb", kept as QGIS style in a GeoPackage
  std::vector<std::array<double, 2>> point;               // in the grid's coordinate system
  std::vector<std::pair<std::string, double>> attribute;  // one column each; not kept in GPX
};

/// As GeoPackage, GeoJSON (RFC 7946: WGS 84) or GPX tracks; the file's extension decides. Throws InputError for
/// extensions other than .gpkg, .geojson, .json and .gpx, and where a format needs WGS 84 and no way to it is known;
/// DeviceError when writing fails. The file is whole or absent.
void write_lines(const std::filesystem::path& path, const MapGrid& grid, const std::string& layer,
                 const std::vector<LineFeature>& lines);

/// Writes polygons of equal class into a GeoPackage, with their QGIS style: layer "classes" (code, class, area_km2,
/// cell_m) in the class layer's coordinate system. A layer of more than `max_cells` cells is read from an overview;
/// column cell_m is the cell size used. Throws DeviceError when writing fails. The file is whole or absent.
void write_class_polygons(const std::filesystem::path& path, const std::filesystem::path& layer, const MapGrid& grid,
                          const std::vector<LegendEntry>& legend, double max_cells = 4e6);

/// The same for codes in memory, row by row from the north, as layer `name`. kClassNoData: no polygon.
void write_cell_polygons(const std::filesystem::path& path, const std::string& name, const MapGrid& grid,
                         const std::vector<std::uint8_t>& code, const std::vector<LegendEntry>& legend);

struct TrackPoint {
  double x = 0, y = 0;                                        // in the grid's coordinate system
  double height = std::numeric_limits<double>::quiet_NaN();   // [m]; NaN: not written
  double seconds = std::numeric_limits<double>::quiet_NaN();  // since the departure [s]; NaN: not written
};

struct Track {
  std::string name;
  std::vector<TrackPoint> point;
};

/// A named place on the way.
struct Stop {
  std::string name;
  TrackPoint at;
};

/// Writes GPX 1.1: tracks with elevation and time, and waypoints. `departure`: seconds since 1970-01-01T00:00:00Z. The
/// file is whole or absent. Throws InputError where no way to WGS 84 is known, DeviceError when writing fails.
void write_gpx(const std::filesystem::path& path, const MapGrid& grid, const std::vector<Stop>& stops,
               const std::vector<Track>& tracks, std::int64_t departure);

}  // namespace gonogo::terrain
