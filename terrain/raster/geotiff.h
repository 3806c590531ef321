// Layers written as cloud-optimised GeoTIFF: 512-cell tiles, DEFLATE, overviews, colour table, names, unit, metadata.
// Beside each file go `<name>.tif.aux.xml` with the class names (GDAL's place for them) and `<name>.qml`, the style
// that QGIS loads by itself.
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

/// Fills a layer window by window and puts the finished file in place with finish(); before that nothing is visible
/// under `path` but an earlier version. Without finish() the scratch file is removed.
class GeoTiffWriter {
 public:
  GeoTiffWriter(std::filesystem::path path, MapGrid grid, LayerInfo info);
  GeoTiffWriter(const GeoTiffWriter&) = delete;
  GeoTiffWriter& operator=(const GeoTiffWriter&) = delete;
  ~GeoTiffWriter();

  /// Values of a window inside the grid; not-a-number becomes nodata.
  void write(Window window, const Tile& tile);

  /// Compresses with `threads` threads (0: all cores); the bits do not depend on their number. Throws DeviceError when
  /// the disk refuses.
  void finish(int threads = 0);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The QGIS style of a layer as text of a .qml file.
std::string qgis_style(const LayerInfo& info);

}  // namespace gonogo::terrain
