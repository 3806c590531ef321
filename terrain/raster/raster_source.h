// Reads rasters window by window, so that memory does not grow with the region.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// How cells are resampled to the map grid.
enum class RasterKind {
  classes,     // nearest cell; most frequent one where the map's cells are larger
  continuous,  // bilinear
};

class RasterSource {
 public:
  /// Opens the elevation raster [m], which defines the map grid. Any format of GDAL; band 1, with scale and offset.
  ///
  /// The raster is warped while it is read when its units are not ground metres within 1 % (degrees, Web Mercator), or
  /// when `wish` asks for another grid. Default: UTM of its own datum, polar stereographic within 6 degrees of a pole,
  /// with cells of the same size. Resampling is cubic; mean where the map's cells are larger.
  ///
  /// Throws InputError with one sentence: no such file, not a raster, no coordinate system, tiles of different ones, no
  /// geotransform, rotated grid, wider than 12 degrees of longitude, nothing but nodata.
  static RasterSource open_elevation(const RasterFiles& files, const GridWish& wish = {});

  /// As open_elevation(), but looks at every cell first and says what it found. Undeclared voids are left out; large
  /// exactly flat areas are told by read_flat(). Throws InputError also for pictures, complex values, a unit of heights
  /// that is not known or contradicts itself, and heights that no ground has. See terrain/raster/height_scan.h.
  static RasterSource open_heights(const RasterFiles& files, const GridWish& wish, const HeightWish& heights);

  /// Opens any raster as it lies: band 1 with scale and offset, on its own grid, in its own unit. Undeclared voids
  /// outside of `range` are left out. Throws InputError: no such file, not a raster, no coordinate system, no
  /// geotransform, rotated grid.
  static RasterSource open_as_it_lies(const RasterFiles& files, const std::optional<ValueRange>& range = {});

  /// Opens another raster, warped to `grid` while it is read. Undeclared voids outside of `range` are left out. Throws
  /// InputError when it cannot be read, has no coordinate system, does not overlap the grid, or when its datum may lie
  /// more than half a cell off.
  static RasterSource open_on_grid(const RasterFiles& files, const MapGrid& grid, RasterKind kind,
                                   const std::optional<ValueRange>& range = {});

  RasterSource(RasterSource&&) noexcept;
  RasterSource& operator=(RasterSource&&) noexcept;
  ~RasterSource();

  /// A second source of the same raster, with its own handles, for another thread.
  RasterSource again() const;

  const MapGrid& grid() const;
  /// For messages.
  std::string name() const;
  /// Unit of the values as the file writes it, "kPa"; empty where it says none.
  const std::string& unit() const;
  /// One sentence about the warping; empty for rasters that are not warped.
  const std::string& how_warped() const;
  /// One sentence each, without a full stop: voids, flat areas and datums that were found.
  const std::vector<std::string>& remarks() const;

  /// Values of the window. Nodata, infinities and cells outside the raster are NaN. Throws InputError for a damaged
  /// file. Not thread-safe.
  Tile read(Window window) const;

  /// 1 in cells of large exactly flat areas, which may be water or voids, 0 elsewhere. Not thread-safe.
  bool has_flat() const;
  Tile read_flat(Window window) const;

 private:
  struct State;
  static RasterSource open(const RasterFiles& files, const GridWish& wish, const HeightWish* heights);
  explicit RasterSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Names that a raster of classes gives its codes, from code 0 on; empty where it gives none.
std::vector<std::string> class_names(const RasterFiles& files);

/// All files that these rasters read, also those that a VRT names.
std::vector<std::filesystem::path> files_behind(const RasterFiles& files);

}  // namespace gonogo::terrain
