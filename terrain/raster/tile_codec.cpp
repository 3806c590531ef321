#include "terrain/raster/tile_codec.h"

#include <cpl_conv.h>

#include <bit>
#include <cstring>
#include <memory>

#include "base/error.h"

namespace gonogo::terrain {
namespace {

static_assert(std::endian::native == std::endian::little, "tiles are written in this machine's order of bytes");

constexpr int kLevel = 6;  // GDAL's default for DEFLATE

struct FreeGdal {
  void operator()(void* memory) const { VSIFree(memory); }
};

std::string deflated(const std::vector<std::uint8_t>& bytes) {
  std::size_t size = 0;
  const std::unique_ptr<void, FreeGdal> packed(CPLZLibDeflate(bytes.data(), bytes.size(), kLevel, nullptr, 0, &size));
  if (!packed) throw DeviceError("CPLZLibDeflate: a tile cannot be compressed, out of memory");
  return {static_cast<const char*>(packed.get()), size};
}

void inflate(std::string_view bytes, std::vector<std::uint8_t>& out, const std::string& where) {
  std::size_t size = 0;
  if (!CPLZLibInflate(bytes.data(), bytes.size(), out.data(), out.size(), &size) || size != out.size())
    throw DeviceError(where + ": a tile of the unfinished map is damaged; remove the file and start again");
}

}  // namespace

std::string encode_tile(const std::vector<std::uint8_t>& cells) {
  std::vector<std::uint8_t> bytes(cells.size());
  for (std::size_t row = 0; row < kTileArea; row += kTileCells) {
    bytes[row] = cells[row];
    for (std::size_t i = row + 1; i < row + kTileCells; ++i) bytes[i] = std::uint8_t(cells[i] - cells[i - 1]);
  }
  return deflated(bytes);
}

void decode_tile(std::string_view bytes, std::vector<std::uint8_t>& cells, const std::string& where) {
  cells.resize(kTileArea);
  inflate(bytes, cells, where);
  for (std::size_t row = 0; row < kTileArea; row += kTileCells)
    for (std::size_t i = row + 1; i < row + kTileCells; ++i) cells[i] = std::uint8_t(cells[i] + cells[i - 1]);
}

// Each row's bytes are sorted by weight, the highest first, and then differenced.
std::string encode_tile(const std::vector<float>& cells) {
  std::vector<std::uint8_t> bytes(4 * cells.size());
  std::uint8_t planes[4 * kTileCells];
  for (std::size_t row = 0; row < kTileArea; row += kTileCells) {
    for (std::size_t i = 0; i < kTileCells; ++i) {
      const auto word = std::bit_cast<std::uint32_t>(cells[row + i]);
      for (std::size_t b = 0; b < 4; ++b) planes[b * kTileCells + i] = std::uint8_t(word >> (24 - 8 * b));
    }
    std::uint8_t* out = &bytes[4 * row];
    out[0] = planes[0];
    for (std::size_t i = 1; i < sizeof planes; ++i) out[i] = std::uint8_t(planes[i] - planes[i - 1]);
  }
  return deflated(bytes);
}

void decode_tile(std::string_view bytes, std::vector<float>& cells, const std::string& where) {
  std::vector<std::uint8_t> planes(4 * kTileArea);
  inflate(bytes, planes, where);
  cells.resize(kTileArea);
  for (std::size_t row = 0; row < kTileArea; row += kTileCells) {
    std::uint8_t* in = &planes[4 * row];
    for (std::size_t i = 1; i < 4 * kTileCells; ++i) in[i] = std::uint8_t(in[i] + in[i - 1]);
    for (std::size_t i = 0; i < kTileCells; ++i) {
      std::uint32_t word = 0;
      for (std::size_t b = 0; b < 4; ++b) word = (word << 8) | in[b * kTileCells + i];
      cells[row + i] = std::bit_cast<float>(word);
    }
  }
}

}  // namespace gonogo::terrain
