// Pictures of finished layers: tiles for viewers, and overlays with their place on the globe for programs that are not
// GIS.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "terrain/raster/layer/geotiff.h"

namespace gonogo::terrain {

/// Reads a finished layer by tile and by cell.
class LayerReader {
 public:
  /// Opens a layer of GeoTiffWriter and its .qml. Throws InputError when they cannot be read.
  explicit LayerReader(const std::filesystem::path& path);
  LayerReader(LayerReader&&) noexcept;
  ~LayerReader();

  int columns() const;
  int rows() const;
  int levels() const;  // 1 + number of overviews
  /// Band description and unit.
  std::string title() const;
  std::string unit() const;
  /// Value of a cell; empty for nodata.
  std::optional<double> value(int column, int row) const;
  /// Label of a class value; "" for others.
  std::string label(double value) const;
  /// A 512-cell tile of a level (0: the map) as PNG with transparent nodata. Empty outside the layer.
  std::optional<std::string> tile_png(int level, int across, int down) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Files written, or why there are none.
struct OverlayAnswer {
  std::vector<std::filesystem::path> files;  // the KML, then one PNG for each piece of the place
  std::string why_not;                       // without a full stop
};

/// Writes a class layer, warped to longitude and latitude, as PNGs with transparent nodata, at most `longest` pixels a
/// side; and the KML that places them on the globe, with a hint for globes of the Moon and Mars. The second piece of a
/// place is the file `png` with "_2" behind its stem. Texts are escaped. Without a way to warp the layer nothing is
/// written. Throws DeviceError when writing fails.
OverlayAnswer write_overlay(const std::filesystem::path& kml, const std::filesystem::path& png,
                            const std::filesystem::path& layer, const GlobePlace& place, const std::string& title,
                            const std::string& description, const std::vector<LegendEntry>& legend, int longest = 2048);

}  // namespace gonogo::terrain
