// Rasters read window by window, so that memory does not grow with the region.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// How the cells of another grid become cells of the map grid.
enum class RasterKind {
  classes,     // codes: the nearest cell, or the most frequent one where the map's cells are larger
  continuous,  // quantities: bilinear
};

class RasterSource {
 public:
  /// The elevation raster, which defines the map grid; values in metres. Any format GDAL reads; band 1, scale and
  /// offset applied. Throws InputError, one sentence each, for: no such file, not a raster, no coordinate system,
  /// coordinates in degrees, no geotransform, rotated or south-up grid, nothing but nodata.
  static RasterSource open_elevation(const std::filesystem::path& path);

  /// Another raster, warped to `grid` while it is read. Throws InputError when it cannot be read, names no coordinate
  /// system or does not overlap the grid.
  static RasterSource open_on_grid(const std::filesystem::path& path, const MapGrid& grid, RasterKind kind);

  RasterSource(RasterSource&&) noexcept;
  RasterSource& operator=(RasterSource&&) noexcept;
  ~RasterSource();

  const MapGrid& grid() const;
  const std::filesystem::path& path() const;

  /// Values of the window; nodata, not-a-number, infinities and everything outside the raster are not-a-number.
  /// Throws InputError when the file is damaged. One thread at a time.
  Tile read(Window window) const;

 private:
  struct State;
  explicit RasterSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace gonogo::terrain
