#include "terrain/raster/layer/png.h"

#include <array>
#include <cstdlib>
#include <span>
#include <string>

#include "base/error.h"
#include "base/files/file.h"
#include "terrain/raster/layer/cog.h"

namespace gonogo::terrain {
namespace {

/// The cyclic redundancy check of PNG (RFC 2083, section 15).
std::uint32_t check_of(const std::string& bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> values{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      values[n] = n;
      for (int k = 0; k < 8; ++k) values[n] = values[n] & 1 ? 0xedb88320u ^ (values[n] >> 1) : values[n] >> 1;
    }
    return values;
  }();
  std::uint32_t check = 0xffffffffu;
  for (const char c : bytes) check = table[(check ^ std::uint8_t(c)) & 255] ^ (check >> 8);
  return check ^ 0xffffffffu;
}

/// Highest byte first.
std::string number(std::uint32_t value) {
  return {char(value >> 24), char(value >> 16 & 255), char(value >> 8 & 255), char(value & 255)};
}

std::string chunk(const std::string& type, const std::string& data) {
  return number(std::uint32_t(data.size())) + type + data + number(check_of(type + data));
}

constexpr std::size_t kBytes = 3;  // of a pixel

/// A row less what stands to the left (filter 1) or above (filter 2), which is `above`.
void filter(int type, std::span<const std::uint8_t> row, std::span<const std::uint8_t> above,
            std::span<std::uint8_t> out) {
  for (std::size_t i = 0; i < row.size(); ++i)
    out[i] = std::uint8_t(row[i] - (type == 2 ? above[i] : i < kBytes ? 0 : row[i - kBytes]));
}

/// By which filters are chosen: the sum of the sizes of differences (RFC 2083, section 9.6).
int size_of(std::span<const std::uint8_t> row) {
  int sum = 0;
  for (const std::uint8_t v : row) sum += std::abs(int(std::int8_t(v)));
  return sum;
}

}  // namespace

void write_png(const std::filesystem::path& path, const RgbPicture& picture) {
  const std::size_t width = kBytes * std::size_t(picture.columns), rows = std::size_t(picture.rows);
  GONOGO_ASSERT(picture.value.size() == width * rows);
  std::vector<std::uint8_t> bytes, left(width), up(width);
  const std::vector<std::uint8_t> nothing(width, 0);
  bytes.reserve((width + 1) * rows);
  for (std::size_t r = 0; r < rows; ++r) {
    const auto row = std::span(picture.value).subspan(r * width, width);
    const auto above = r > 0 ? std::span(picture.value).subspan((r - 1) * width, width) : std::span(nothing);
    filter(1, row, above, left);
    filter(2, row, above, up);
    const bool by_left = size_of(left) < size_of(up);
    bytes.push_back(by_left ? 1 : 2);
    bytes.insert(bytes.end(), (by_left ? left : up).begin(), (by_left ? left : up).end());
  }
  // Eight bits a sample, three samples, deflate, filters by row, not interlaced.
  const std::string header =
      number(std::uint32_t(picture.columns)) + number(std::uint32_t(picture.rows)) + std::string{8, 2, 0, 0, 0};
  write_file_atomically(
      path, "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", deflated(bytes)) + chunk("IEND", ""));
}

}  // namespace gonogo::terrain
