// The grid of a map on the ground and on its globe, windows of cells, and their values.
#pragma once
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::terrain {

/// One raster: a file, or tiles in one coordinate system.
struct RasterFiles {
  std::vector<std::filesystem::path> file;

  RasterFiles() = default;
  RasterFiles(std::filesystem::path one) : file{std::move(one)} {}                   // NOLINT: a raster is its file
  RasterFiles(const std::string& one) : file{one} {}                                 // NOLINT
  RasterFiles(const char* one) : file{one} {}                                        // NOLINT
  RasterFiles(std::vector<std::filesystem::path> tiles) : file(std::move(tiles)) {}  // NOLINT
  /// For messages.
  std::string name() const {
    return file.empty() ? "" : file.front().string() + (file.size() > 1 ? " and its other tiles" : "");
  }
};

/// Wishes for the grid of a map. Empty fields follow from the elevation raster.
struct GridWish {
  std::string crs;       // any form that PROJ reads, for example "EPSG:32611"
  double cell_size = 0;  // [m]
};

/// What is known of the heights of an elevation raster beyond what it says itself.
struct HeightWish {
  std::string unit;             // "m", "ft" or "us-ft"; empty: as the raster says
  bool flat_is_ground = false;  // large exactly flat areas are ground, neither water nor voids
};

/// What the values of a raster can be, in its own unit after scale and offset. Others are no measurements.
struct ValueRange {
  double low = 0, high = 0;
  std::string what;  // "cone index"
};

/// A north-up grid of equal cells in a projected or local coordinate system. Row 0 is the northernmost.
struct MapGrid {
  int columns = 0, rows = 0;
  double west = 0, north = 0;              // outer corner of cell (0, 0) [units of the CRS]
  double cell_width = 0, cell_height = 0;  // both positive [units of the CRS]
  double metres_per_unit = 1;              // of the CRS
  std::string crs_wkt;                     // WKT2
  std::string crs_name;                    // "NAD83 / UTM zone 11N"
  std::string crs_code;                    // "EPSG:26911", or empty when the file names no authority
  std::string unit_name = "metre";         // of the CRS
  double body_radius = 6378137;            // equatorial, of the body whose ground it is [m]

  double east() const { return west + columns * cell_width; }
  double south() const { return north - rows * cell_height; }
  double cell_width_m() const { return cell_width * metres_per_unit; }
  double cell_height_m() const { return cell_height * metres_per_unit; }
  double cell_area_m2() const { return cell_width_m() * cell_height_m(); }
};

/// Rectangle of cells. It may reach beyond the grid; cells there have no data.
struct Window {
  int column = 0, row = 0, columns = 0, rows = 0;
};

/// Windows of so many cells that cover the grid, row by row; smaller ones at its end.
std::vector<Window> windows_of(const MapGrid& grid, int columns, int rows);

/// The mark of a cell without a value.
inline constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();
inline bool has_data(float value) { return !std::isnan(value); }

/// Values of a window, row by row from the north: [rows * columns]. kNoData: none.
struct Tile {
  int columns = 0, rows = 0;
  std::vector<float> value;

  Tile() = default;
  Tile(int columns_, int rows_, float fill)
      : columns(columns_), rows(rows_), value(std::size_t(columns_) * rows_, fill) {}
  float& at(int column, int row) { return value[std::size_t(row) * columns + column]; }
  float at(int column, int row) const { return value[std::size_t(row) * columns + column]; }
};

/// A body whose ground is mapped, told apart by the radius of its coordinate systems.
struct Body {
  const char* name;
  const char* with_article;  // in a sentence
  double radius;             // equatorial or mean [m]
  double gravity;            // at the surface [m/s^2]
};

/// Radii: IAU Working Group on Cartographic Coordinates 2015 (Archinal et al., Celest. Mech. Dyn. Astron. 130:22,
/// 2018). Gravity: NASA planetary fact sheets (nssdc.gsfc.nasa.gov/planetary/factsheet); Titan's is GM over the radius
/// squared.
inline constexpr std::array<Body, 6> kBodies{{{"Earth", "the Earth", 6378137, 9.81},
                                              {"Moon", "the Moon", 1737400, 1.62},
                                              {"Mars", "Mars", 3396190, 3.71},
                                              {"Mercury", "Mercury", 2440530, 3.70},
                                              {"Venus", "Venus", 6051800, 8.87},
                                              {"Titan", "Titan", 2575000, 1.35}}};

/// By the radius [m] within 1 %.
inline std::optional<Body> body_of_radius(double radius) {
  for (const Body& body : kBodies)
    if (std::abs(radius / body.radius - 1) < 0.01) return body;
  return std::nullopt;
}

/// Bounds [deg]. Across the antimeridian east is less than west.
struct DegreeBox {
  double west = 0, south = 0, east = 0, north = 0;
  double width() const { return east < west ? east - west + 360 : east - west; }
};

/// Closed ring of {longitude, latitude} [deg], counter-clockwise.
using DegreeRing = std::vector<std::array<double, 2>>;

/// Where a grid lies on its globe. Longitudes count eastward. They are WGS 84 where a way from the grid's system to it
/// is known, otherwise those of the grid's own datum, fixed to its body.
struct GlobePlace {
  bool is_wgs84 = true;
  std::string system;               // name of the geographic coordinate system
  std::string wkt;                  // the same as WKT2
  std::string body;                 // as in kBodies, or empty for another radius
  DegreeBox box;                    // all of the grid
  std::vector<DegreeBox> pieces;    // the box; two west and east of the antimeridian if it crosses it
  std::vector<DegreeRing> outline;  // [piece] the grid's corners; the box if the grid holds a pole
};

/// The place, or why there is none.
struct GlobeAnswer {
  std::optional<GlobePlace> place;
  std::string why_not;  // without a full stop
};
GlobeAnswer place_on_globe(const MapGrid& grid);

/// Longitude and latitude of nodes that divide the grid evenly, corners included, row by row from the north [rows *
/// columns]. Longitudes run on beyond 180 where they must, so that neighbours are near each other.
struct DegreeNodes {
  int columns = 0, rows = 0;
  std::vector<double> longitude, latitude;  // [deg]
};
/// At most `most` nodes a side. Nothing for a grid that holds a pole, where longitudes cannot be interpolated.
std::optional<DegreeNodes> degree_nodes(const MapGrid& grid, const GlobePlace& place, int most);

/// "the map's degrees are fixed to the Moon (GCS_Moon_2000), not WGS 84"; empty for WGS 84.
std::string remark_on(const GlobePlace& place);

}  // namespace gonogo::terrain
