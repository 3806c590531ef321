// Writes layers as files: cloud-optimised GeoTIFFs with names, colours and QGIS style, and several layers of numbers in
// one GeoTIFF or NetCDF file.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// A class of a byte layer, or a stop of a continuous layer's colour ramp. Colour: "#rrggbb".
struct LegendEntry {
  double value = 0;
  std::string label, colour;
};

struct LayerInfo {
  std::string name;      // band description
  std::string unit;      // "" for classes
  bool classes = false;  // true: bytes, nodata 255; false: float32, nodata -9999
  std::vector<LegendEntry> legend;
  std::vector<std::pair<std::string, std::string>> metadata;
  bool smooth = false;  // of floats: neighbours differ a little. Those of a table repeat, and pack best as they are
};

/// Cells along the side of a tile.
inline constexpr int kTileCells = 512;
inline constexpr std::size_t kTileArea = std::size_t(kTileCells) * kTileCells;

inline constexpr double kFloatNoData = -9999, kClassNoData = 255;

/// Writes a cloud-optimised GeoTIFF: 512-cell tiles, DEFLATE, overviews, colour table, names, unit, metadata. Two files
/// go with each: `<name>.tif.aux.xml` with class names and attribute table, where GDAL looks for them, and
/// `<name>.qml`, the style that QGIS loads by itself.
///
/// Takes the layer tile by tile, in any order and from any thread. finish() puts the file in place; until then `path`
/// keeps its earlier version. Compressed tiles wait in a scratch file, so that memory does not grow with the layer.
class GeoTiffWriter {
 public:
  /// Without a `key` the destructor removes the scratch file. With one it stays until finish(), and the next writer of
  /// the same path and key continues from it.
  GeoTiffWriter(const std::filesystem::path& path, const MapGrid& grid, const LayerInfo& info,
                const std::string& key = "");
  GeoTiffWriter(const GeoTiffWriter&) = delete;
  GeoTiffWriter& operator=(const GeoTiffWriter&) = delete;
  ~GeoTiffWriter();

  /// The window must lie inside the grid and consist of whole tiles of kTileCells, or of what is left at the grid's
  /// end. NaN becomes nodata.
  void write(Window window, const Tile& tile);
  /// Whether the tile with this cell has been written.
  bool has_tile(int column, int row) const;

  /// Makes the overviews and the file, with `threads` threads (0: all cores), whose number does not change the bits. An
  /// overview cell is the mean of the valid ones of 2 x 2 cells, or the most frequent class; of equally frequent
  /// classes the higher code. Throws DeviceError when writing fails.
  void finish(int threads = 0);
  /// Removes the scratch file kept for the next writer of this key.
  void forget();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Escapes text for XML. Control characters, which XML does not allow, become spaces.
std::string xml_escaped(const std::string& text);

/// Text of a layer's .qml file.
std::string qgis_style(const LayerInfo& info);

/// A layer of a file of several.
struct FloatLayer {
  std::string name, unit;  // the name becomes the band's description, or the variable of the NetCDF file
};

/// Values of a row of a layer [columns]; NaN: nodata.
using RowOfLayer = std::function<std::vector<float>(std::size_t layer, int row)>;

/// Writes layers that share a grid. .tif: one band a layer, DEFLATE, nodata NaN. .nc: one float variable a layer, y
/// from south to north as CF asks, NaN as _FillValue. `metadata` goes into both. Rows are asked for in the order of
/// rows, layer by layer. Throws InputError for other extensions, DeviceError when writing fails. The file is whole or
/// absent.
void write_float_layers(const std::filesystem::path& path, const MapGrid& grid, const std::vector<FloatLayer>& layers,
                        const std::vector<std::pair<std::string, std::string>>& metadata, const RowOfLayer& row_of);

/// Outer corner of the first cell, and cells, in units of the coordinate system.
struct ValuesPlace {
  double west, north, cell_width, cell_height;
};

/// Writes one north-up layer as GeoTIFF, NaN as nodata. `crs`: any form that PROJ reads. `unit`: of the values, or
/// empty. Throws InputError for a system that PROJ does not know, DeviceError when writing fails. The file is whole or
/// absent.
void write_values(const std::filesystem::path& path, const Tile& values, const ValuesPlace& place,
                  const std::string& crs, const std::string& unit);

}  // namespace gonogo::terrain
