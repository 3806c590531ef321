// A finished layer read again, tile by tile and cell by cell, for showing it.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

class LayerReader {
 public:
  /// A layer written by GeoTiffWriter, with its .qml beside it. Throws InputError when it cannot be read.
  explicit LayerReader(const std::filesystem::path& path);
  LayerReader(LayerReader&&) noexcept;
  ~LayerReader();

  int columns() const;
  int rows() const;
  int levels() const;  // 1 + overviews
  /// Band description and unit.
  std::string title() const;
  std::string unit() const;
  /// Value of a cell, or nothing where nodata.
  std::optional<double> value(int column, int row) const;
  /// The label of a class value, or "".
  std::string label(double value) const;
  /// A 512-cell tile of a level (0: the map) as PNG with transparent nodata; nothing outside the layer.
  std::optional<std::string> tile_png(int level, int across, int down) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gonogo::terrain
