// The grid of a map on the ground, windows of cells, and their values.
#pragma once
#include <filesystem>
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

/// A north-up grid of equal cells in a projected coordinate system. Row 0 is the northernmost.
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

  double cell_width_m() const { return cell_width * metres_per_unit; }
  double cell_height_m() const { return cell_height * metres_per_unit; }
  double cell_area_m2() const { return cell_width_m() * cell_height_m(); }
};

/// Rectangle of cells. It may reach beyond the grid; cells there have no data.
struct Window {
  int column = 0, row = 0, columns = 0, rows = 0;
};

/// Values of a window, row by row from the north: [rows * columns]. NaN: nodata.
struct Tile {
  int columns = 0, rows = 0;
  std::vector<float> value;

  Tile() = default;
  Tile(int columns_, int rows_, float fill)
      : columns(columns_), rows(rows_), value(std::size_t(columns_) * rows_, fill) {}
  float& at(int column, int row) { return value[std::size_t(row) * columns + column]; }
  float at(int column, int row) const { return value[std::size_t(row) * columns + column]; }
};

}  // namespace gonogo::terrain
