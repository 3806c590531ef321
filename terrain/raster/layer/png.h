// Pictures in memory as PNG files.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace gonogo::terrain {

/// Red, green and blue of every pixel, row by row from the top [rows x columns x 3].
struct RgbPicture {
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> value;
};

/// Compressed by GDAL's deflate, which is several times faster than that of libpng. Throws DeviceError.
void write_png(const std::filesystem::path& path, const RgbPicture& picture);

}  // namespace gonogo::terrain
