// What stays of a block when its layers are written: counts, and the cells that figure and page show. Kept in a file,
// so that an interrupted map goes on with the next block.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/block.h"
#include "pipeline/map/evaluate/speed_curve.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/write/map_page.h"
#include "pipeline/map/write/picture.h"

namespace gonogo::map {

/// The things that digests of all blocks add up to.
struct MapDigest {
  AreaCount area;
  Picture picture;
  PageCells page;
  SpeedCurve speeds{};
};

std::string digest_of(const BlockLayers& block, const SoilTable& table, const terrain::MapGrid& grid,
                      const MapDigest& shape, const std::vector<MapLayer>& layers);

/// Adds the digest of the block at `window`. Throws DeviceError, `where` first, when it is not one of this map.
void add_digest(const std::string& bytes, terrain::Window window, const terrain::MapGrid& grid, SoilTable& table,
                MapDigest& digest, const std::string& where);

}  // namespace gonogo::map
