// Reads a finished layer by tile and by cell, for viewers.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

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

}  // namespace gonogo::terrain
