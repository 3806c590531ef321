// A map made block by block, in threads: a block is a tile of the GeoTIFFs. What a killed run finished is kept beside
// the map and taken up by the next run of the same inputs.
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

class MapBlocks {
 public:
  /// `key` tells maps of different inputs apart.
  MapBlocks(const MapRequest& request, const terrain::MapGrid& grid, std::vector<MapLayer> layers,
            const std::string& key);

  /// Evaluates the blocks that are missing; InputError, DeviceError or Cancelled leave the others for the next run.
  void evaluate(const MapSources& sources, const SoilTable& table, const MapDigest& shape);
  /// Adds up what the blocks say.
  void collect(SoilTable& table, MapDigest& digest) const;
  /// Puts the GeoTIFFs in place and returns their names.
  std::vector<std::filesystem::path> finish();
  /// Removes what is kept for the next run.
  void forget();
  const std::vector<MapLayer>& layers() const { return layers_; }
  std::size_t found() const { return found_; }

 private:
  std::vector<terrain::Window> windows() const;
  bool is_done(std::uint32_t block, terrain::Window window) const;

  const MapRequest& request_;
  terrain::MapGrid grid_;
  std::vector<MapLayer> layers_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<terrain::GeoTiffWriter>> writers_;
  RecordLog digests_;
  std::size_t found_ = 0;  // blocks of an earlier run
};

}  // namespace gonogo::map
