// Evaluates a map tile by tile, in threads, and keeps what figure and page show. Finished tiles are kept in scratch
// files beside the map, and the next run with the same inputs uses them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/files/record_log.h"
#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/write/make_map.h"
#include "pipeline/map/write/map_page.h"
#include "terrain/raster/grid.h"
#include "terrain/raster/layer/geotiff.h"

namespace gonogo::map {

/// Cells along the longer side of a figure's map.
inline constexpr int kPictureCells = 1600;

/// A reduced copy of the layers for the figure. Its size does not grow with the raster. Every cell shows the map's cell
/// under its centre.
struct Picture {
  terrain::Tile shade, verdict, reason, p_go;

  /// Sized for `grid`, with at most `longest` cells along the longer side.
  Picture(const terrain::MapGrid& grid, int longest);
};

/// What is kept of a map once its layers are written: counts, and the cells that figure and page show. It is the sum of
/// the digests of its tiles, which are kept in a file, so that an interrupted map continues with the next tile.
struct MapDigest {
  AreaCount area;
  Picture picture;
  PageCells page;
  SpeedCurve speeds{};
  std::uint64_t steeper = 0;             // cells with a known soil that are steeper than the steepest sampled slope
  std::uint64_t unanswered_ditches = 0;  // cells of a ditch that the model for ditches leaves unknown
  std::map<std::uint32_t, std::uint64_t> rules{};  // cells by position in land_rules(), where a rule decides
};

/// The tiles of a map, which are those of its GeoTIFFs.
class MapTiles {
 public:
  /// Opens the scratch files. `key` identifies the inputs; tiles of another key are discarded.
  MapTiles(const MapRequest& request, const terrain::MapGrid& grid, std::vector<MapLayer> layers,
           const std::string& key);

  /// Evaluates the missing tiles. InputError, DeviceError and Cancelled keep the finished ones for the next run.
  void evaluate(const MapSources& sources, const SoilTable& table, const MapDigest& shape);
  /// Adds the digests of all tiles to `digest`, and their cell counts to `table`.
  void collect(SoilTable& table, MapDigest& digest) const;
  /// Writes the GeoTIFFs from the scratch files and returns their paths.
  std::vector<std::filesystem::path> finish();
  /// Removes the scratch files.
  void forget();
  const std::vector<MapLayer>& layers() const { return layers_; }
  std::size_t found() const { return found_; }

 private:
  bool is_done(std::uint32_t tile, terrain::Window window) const;

  const MapRequest& request_;
  terrain::MapGrid grid_;
  std::vector<MapLayer> layers_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<terrain::GeoTiffWriter>> writers_;
  RecordLog digests_;
  std::size_t found_ = 0;  // tiles that an earlier run had finished
};

}  // namespace gonogo::map
