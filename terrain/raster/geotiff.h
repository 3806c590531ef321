// Layers written as cloud-optimised GeoTIFF: 512-cell tiles, DEFLATE, overviews, colour table, names, unit, metadata.
// Beside each file go `<name>.tif.aux.xml` with the class names and the attribute table (GDAL's place for them) and
// `<name>.qml`, the style that QGIS loads by itself.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// A class value of a byte layer, or a stop of the colour ramp of a continuous one. Colour as "#rrggbb".
struct LegendEntry {
  double value = 0;
  std::string label, colour;
};

struct LayerInfo {
  std::string name;      // band description
  std::string unit;      // "" for classes
  bool classes = false;  // byte classes with nodata 255, or float32 with nodata -9999
  std::vector<LegendEntry> legend;
  std::vector<std::pair<std::string, std::string>> metadata;
};

inline constexpr double kFloatNoData = -9999, kClassNoData = 255;

/// Takes a layer tile by tile, in any order and from any thread, and puts the finished file in place with finish();
/// before that nothing is visible under `path` but an earlier version. Tiles are kept compressed in a scratch file, so
/// memory does not grow with the layer.
class GeoTiffWriter {
 public:
  /// Without a `key` the scratch file is removed when the writer goes. With one it stays until finish(), and a writer
  /// of the same path and key finds the tiles that an interrupted one wrote.
  GeoTiffWriter(std::filesystem::path path, MapGrid grid, LayerInfo info, std::string key = "");
  GeoTiffWriter(const GeoTiffWriter&) = delete;
  GeoTiffWriter& operator=(const GeoTiffWriter&) = delete;
  ~GeoTiffWriter();

  /// Values of a window inside the grid that is made of whole tiles (kTileCells; at the grid's end what is left);
  /// not-a-number becomes nodata.
  void write(Window window, const Tile& tile);
  /// Whether the tile that holds this cell was written.
  bool has_tile(int column, int row) const;

  /// Makes the overviews (numbers: mean of the valid ones of 2 x 2 cells; classes: the most frequent, of equally
  /// frequent ones the higher code), with `threads` threads (0: all cores); the bits do not depend on their number.
  /// Throws DeviceError when the disk refuses.
  void finish(int threads = 0);
  /// Removes the tiles kept for another writer of the same key.
  void forget();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The QGIS style of a layer as text of a .qml file.
std::string qgis_style(const LayerInfo& info);

}  // namespace gonogo::terrain
