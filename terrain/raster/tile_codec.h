// Encodes a tile of a GeoTIFF: predictor of TIFF 6.0 section 14 (bytes) or of Adobe's TIFF Technical Note 3 (floats),
// then DEFLATE by GDAL's own routine at its default level.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gonogo::terrain {

/// Cells along the side of a tile.
inline constexpr int kTileCells = 512;
inline constexpr std::size_t kTileArea = std::size_t(kTileCells) * kTileCells;

/// `cells`: kTileArea values, row by row. Edge tiles are padded with nodata.
std::string encode_tile(const std::vector<std::uint8_t>& cells);
std::string encode_tile(const std::vector<float>& cells);

/// The reverse. Throws DeviceError, which begins with `where`, when the bytes are not such a tile.
void decode_tile(std::string_view bytes, std::vector<std::uint8_t>& cells, const std::string& where);
void decode_tile(std::string_view bytes, std::vector<float>& cells, const std::string& where);

}  // namespace gonogo::terrain
