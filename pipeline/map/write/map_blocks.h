// Evaluates a map tile by tile, in threads. A map tile is a tile of the GeoTIFFs. Finished tiles are kept in scratch
// files beside the map, and the next run with the same inputs uses them.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/record_log.h"
#include "pipeline/map/write/block_digest.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/raster/geotiff.h"

namespace gonogo::map {

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
  std::vector<terrain::Window> windows() const;
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
