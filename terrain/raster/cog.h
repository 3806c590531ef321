// A cloud-optimised GeoTIFF put together from finished tiles: directories first, then the overviews from the smallest
// to the largest, then the map; tiles row by row, each between its size and a repetition of its last four bytes, as
// GDAL's own COG driver writes them (GDAL documentation, "COG -- Cloud Optimized GeoTIFF generator", file format
// details). Larger than 4 GB it becomes a BigTIFF.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"
#include "terrain/raster/tile_codec.h"

namespace gonogo::terrain {

struct CogLevel {
  int columns = 0, rows = 0;  // cells
  int tiles_across() const { return (columns + kTileCells - 1) / kTileCells; }
  int tiles_down() const { return (rows + kTileCells - 1) / kTileCells; }
  std::uint32_t tiles() const { return std::uint32_t(tiles_across()) * std::uint32_t(tiles_down()); }
};

/// The map and its overviews, each half as wide and high (rounded up), down to one that fits into a tile.
std::vector<CogLevel> cog_levels(int columns, int rows);

/// Number of the first tile of a level, when the tiles of all levels are counted through.
std::uint32_t first_tile(const std::vector<CogLevel>& levels, std::size_t level);

/// Where the tiles come from, by their number.
struct CogTiles {
  std::function<std::size_t(std::uint32_t)> size;
  std::function<std::string(std::uint32_t)> bytes;
};

/// Writes to `path`; throws DeviceError when the disk refuses.
void write_cog(const std::filesystem::path& path, const MapGrid& grid, const LayerInfo& info,
               const std::vector<CogLevel>& levels, const CogTiles& tiles);

}  // namespace gonogo::terrain
