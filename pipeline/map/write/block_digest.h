// What is kept of a map tile once its layers are written: counts, and the cells that figure and page show. Digests are
// kept in a file, so an interrupted map continues with the next tile.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/block.h"
#include "pipeline/map/evaluate/speed_curve.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/write/map_page.h"
#include "pipeline/map/write/picture.h"

namespace gonogo::map {

/// The sum of the digests of all tiles.
struct MapDigest {
  AreaCount area;
  Picture picture;
  PageCells page;
  SpeedCurve speeds{};
  std::uint64_t steeper = 0;             // cells with a known soil that are steeper than the steepest sampled slope
  std::uint64_t unanswered_ditches = 0;  // cells of a ditch that the model for ditches leaves unknown
  std::map<std::uint32_t, std::uint64_t> rules{};  // cells by 1 + position in land_rules(), where a rule decides
};

/// Digest of a tile as bytes. `shape` gives the sizes of picture and page; its contents are ignored.
std::string digest_of(const TileLayers& tile, const SoilTable& table, const terrain::MapGrid& grid,
                      const MapDigest& shape, const std::vector<MapLayer>& layers);

/// Adds the digest of the tile at `window` to `digest` and to the cell counts of `table`. Throws DeviceError for
/// damaged bytes, with `where` first.
void add_digest(const std::string& bytes, terrain::Window window, const terrain::MapGrid& grid, SoilTable& table,
                MapDigest& digest, const std::string& where);

}  // namespace gonogo::map
