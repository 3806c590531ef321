// Writes a cloud-optimised GeoTIFF from finished tiles: the directories, the overviews from the smallest to the
// largest, then the map. Tiles go row by row, each after its size and before a copy of its last four bytes, as GDAL's
// COG driver does (GDAL documentation, "COG -- Cloud Optimized GeoTIFF generator", file format details). A file larger
// than 4 GB is a BigTIFF.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "terrain/raster/layer/geotiff.h"

namespace gonogo::terrain {

/// Encodes a tile: smooth floats by the predictor of Adobe's TIFF Technical Note 3, then DEFLATE by GDAL's own routine.
/// `cells`: kTileArea values, row by row. Edge tiles are padded with nodata.
std::string encode_tile(const std::vector<std::uint8_t>& cells, bool smooth);
std::string encode_tile(const std::vector<float>& cells, bool smooth);

/// The reverse. Throws DeviceError, which begins with `where`, when the bytes are not such a tile.
void decode_tile(std::string_view bytes, std::vector<std::uint8_t>& cells, bool smooth, const std::string& where);
void decode_tile(std::string_view bytes, std::vector<float>& cells, bool smooth, const std::string& where);

struct CogLevel {
  int columns = 0, rows = 0;  // cells
  int tiles_across() const { return (columns + kTileCells - 1) / kTileCells; }
  int tiles_down() const { return (rows + kTileCells - 1) / kTileCells; }
  std::uint32_t tiles() const { return std::uint32_t(tiles_across()) * std::uint32_t(tiles_down()); }
};

/// The map and its overviews. Each has half the width and height, rounded up; the last fits into one tile.
std::vector<CogLevel> cog_levels(int columns, int rows);

/// Number of a level's first tile, where the tiles of all levels are numbered in one sequence.
std::uint32_t first_tile(const std::vector<CogLevel>& levels, std::size_t level);

/// Source of the tiles, by number.
struct CogTiles {
  std::function<std::size_t(std::uint32_t)> size;
  std::function<std::string(std::uint32_t)> bytes;
};

/// Throws DeviceError when writing fails.
void write_cog(const std::filesystem::path& path, const MapGrid& grid, const LayerInfo& info,
               const std::vector<CogLevel>& levels, const CogTiles& tiles);

}  // namespace gonogo::terrain
