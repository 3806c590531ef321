// Rasters read window by window, so that memory does not grow with the region.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// How the cells of another grid become cells of the map grid.
enum class RasterKind {
  classes,     // codes: the nearest cell, or the most frequent one where the map's cells are larger
  continuous,  // quantities: bilinear
};

class RasterSource {
 public:
  /// The elevation raster, which defines the map grid; values in metres. Any format GDAL reads, one file or tiles;
  /// band 1, scale and offset applied. A raster whose map units are not ground metres within 1 % (degrees, Web
  /// Mercator), or for which `wish` asks another grid, is warped while it is read: to UTM of its own datum (within 6
  /// degrees of a pole polar stereographic), cells as large as its own, cubic (mean where the map's cells are larger).
  /// Throws InputError, one sentence each, for: no such file, not a raster, no coordinate system, tiles of different
  /// ones, no geotransform, rotated or south-up grid, a longer way east than 12 degrees, nothing but nodata.
  static RasterSource open_elevation(const RasterFiles& files, const GridWish& wish = {});

  /// Another raster, warped to `grid` while it is read. Throws InputError when it cannot be read, names no coordinate
  /// system, does not overlap the grid, or when the way between their datums is not known.
  static RasterSource open_on_grid(const RasterFiles& files, const MapGrid& grid, RasterKind kind);

  RasterSource(RasterSource&&) noexcept;
  RasterSource& operator=(RasterSource&&) noexcept;
  ~RasterSource();

  /// The same raster with handles of its own, for another thread.
  RasterSource again() const;

  const MapGrid& grid() const;
  /// For messages.
  std::string name() const;
  /// One sentence when the elevation was warped, otherwise empty.
  const std::string& how_warped() const;

  /// Values of the window; nodata, not-a-number, infinities and everything outside the raster are not-a-number.
  /// Throws InputError when the file is damaged. One thread at a time.
  Tile read(Window window) const;

 private:
  struct State;
  explicit RasterSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Every file that reading these rasters reads: of a VRT also those that it names.
std::vector<std::filesystem::path> files_behind(const RasterFiles& files);

}  // namespace gonogo::terrain
