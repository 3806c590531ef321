#include "terrain/raster/cog.h"

#include <cpl_vsi.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "terrain/raster/tiff_tags.h"

namespace gonogo::terrain {
namespace {

enum Type : std::uint16_t { kShort = 3, kLong = 4, kLong8 = 16 };

constexpr std::uint16_t kTileOffsets = 324, kTileByteCounts = 325;

/// What GDAL puts between header and first directory, so that readers know the order without looking.
const std::string kLayoutText =
    "GDAL_STRUCTURAL_METADATA_SIZE=000140 bytes\n"
    "LAYOUT=IFDS_BEFORE_DATA\nBLOCK_ORDER=ROW_MAJOR\nBLOCK_LEADER=SIZE_AS_UINT4\n"
    "BLOCK_TRAILER=LAST_4_BYTES_REPEATED\nKNOWN_INCOMPATIBLE_EDITION=NO\n ";

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

TiffTag number(std::uint16_t tag, Type type, const std::vector<std::uint64_t>& values) {
  TiffTag result{tag, type, values.size(), ""};
  for (const std::uint64_t v : values) {
    if (type == kShort) put(result.data, std::uint16_t(v));
    if (type == kLong) put(result.data, std::uint32_t(v));
    if (type == kLong8) put(result.data, v);
  }
  return result;
}

/// Offsets and sizes of a level's tiles.
struct Placement {
  std::vector<std::uint64_t> offset, size;
};

/// TIFF 6.0: the tags of one directory, in the order of their numbers.
std::vector<TiffTag> directory_tags(const CogLevel& level, bool overview, const LayerInfo& info,
                                    const std::vector<TiffTag>& described, const Placement& place, bool big) {
  const std::uint64_t bits = info.classes ? 8 : 32, photometric = info.classes ? 3 : 1;  // palette or black is zero
  std::vector<TiffTag> tags = {number(254, kLong, {overview ? 1u : 0u}),
                               number(256, kLong, {std::uint64_t(level.columns)}),
                               number(257, kLong, {std::uint64_t(level.rows)}),
                               number(258, kShort, {bits}),
                               number(259, kShort, {8}),  // DEFLATE
                               number(262, kShort, {photometric}),
                               number(277, kShort, {1}),
                               number(284, kShort, {1}),
                               number(317, kShort, {info.classes ? 2u : 3u}),  // predictor
                               number(322, kShort, {kTileCells}),
                               number(323, kShort, {kTileCells}),
                               number(kTileOffsets, big ? kLong8 : kLong, place.offset),
                               number(kTileByteCounts, kLong, place.size),
                               number(339, kShort, {info.classes ? 1u : 3u})};  // unsigned or IEEE
  for (const TiffTag& tag : described)
    if (!overview || tag.tag == kColourMap || tag.tag == kGdalNoData) tags.push_back(tag);
  std::sort(tags.begin(), tags.end(), [](const TiffTag& a, const TiffTag& b) { return a.tag < b.tag; });
  return tags;
}

std::string directory_bytes(const std::vector<TiffTag>& tags, std::uint64_t at, bool last, bool big) {
  const std::size_t room = big ? 8 : 4, head = big ? 8 : 2, entry = big ? 20 : 12;
  std::string out, outside;
  const std::uint64_t outside_at = at + head + entry * tags.size() + room;
  big ? put(out, std::uint64_t(tags.size())) : put(out, std::uint16_t(tags.size()));
  for (const TiffTag& tag : tags) {
    put(out, tag.tag);
    put(out, tag.type);
    big ? put(out, std::uint64_t(tag.count)) : put(out, std::uint32_t(tag.count));
    std::string value = tag.data;
    if (value.size() > room) {
      value.clear();
      const std::uint64_t where = outside_at + outside.size();
      big ? put(value, where) : put(value, std::uint32_t(where));
      outside += tag.data + std::string(tag.data.size() % 2, '\0');
    }
    value.resize(room, '\0');
    out += value;
  }
  const std::uint64_t next = last ? 0 : outside_at + outside.size() + outside.size() % 2;
  big ? put(out, next) : put(out, std::uint32_t(next));
  return out + outside;
}

std::string header(bool big) {
  std::string out = "II";
  const std::size_t length = (big ? 16 : 8) + kLayoutText.size();
  const std::size_t first = length + length % 2;
  if (big) {
    put(out, std::uint16_t(43));
    put(out, std::uint16_t(8));
    put(out, std::uint16_t(0));
    put(out, std::uint64_t(first));
  } else {
    put(out, std::uint16_t(42));
    put(out, std::uint32_t(first));
  }
  out += kLayoutText;
  out.resize(first, '\0');
  return out;
}

std::string all_directories(const std::vector<CogLevel>& levels, const LayerInfo& info,
                            const std::vector<TiffTag>& described, const std::vector<Placement>& places, bool big) {
  std::string out = header(big);
  for (std::size_t l = 0; l < levels.size(); ++l)
    out += directory_bytes(directory_tags(levels[l], l > 0, info, described, places[l], big), out.size(),
                           l + 1 == levels.size(), big);
  return out;
}

/// Tiles lie behind `begin`, the smallest level first, four bytes before and four after each.
std::vector<Placement> place_tiles(const std::vector<CogLevel>& levels, const CogTiles& tiles, std::uint64_t begin,
                                   std::uint64_t& end) {
  std::vector<Placement> places(levels.size());
  end = begin;
  for (std::size_t l = levels.size(); l-- > 0;)
    for (std::uint32_t t = 0; t < levels[l].tiles(); ++t) {
      const std::uint64_t size = tiles.size(first_tile(levels, l) + t);
      places[l].offset.push_back(end + 4);
      places[l].size.push_back(size);
      end += size + 8;
    }
  return places;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

void write_bytes(std::FILE& file, const std::string& bytes, const std::filesystem::path& path) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), &file) != bytes.size())
    throw DeviceError(path.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace

std::vector<CogLevel> cog_levels(int columns, int rows) {
  std::vector<CogLevel> levels = {{columns, rows}};
  while (std::max(levels.back().columns, levels.back().rows) > kTileCells)
    levels.push_back({(levels.back().columns + 1) / 2, (levels.back().rows + 1) / 2});
  return levels;
}

std::uint32_t first_tile(const std::vector<CogLevel>& levels, std::size_t level) {
  std::uint32_t first = 0;
  for (std::size_t l = 0; l < level; ++l) first += levels[l].tiles();
  return first;
}

void write_cog(const std::filesystem::path& path, const MapGrid& grid, const LayerInfo& info,
               const std::vector<CogLevel>& levels, const CogTiles& tiles) {
  const std::vector<TiffTag> described = describing_tags(grid, info);
  std::uint64_t end = 0;
  std::vector<Placement> places = place_tiles(levels, tiles, 0, end);
  const bool big = end > 4'200'000'000u;
  places = place_tiles(levels, tiles, all_directories(levels, info, described, places, big).size(), end);
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "wb"));
  if (!file) throw DeviceError(path.string() + ": cannot be written: " + std::strerror(errno));
  write_bytes(*file, all_directories(levels, info, described, places, big), path);
  for (std::size_t l = levels.size(); l-- > 0;)
    for (std::uint32_t t = 0; t < levels[l].tiles(); ++t) {
      const std::string bytes = tiles.bytes(first_tile(levels, l) + t);
      std::string framed;
      put(framed, std::uint32_t(bytes.size()));
      write_bytes(*file, framed + bytes + bytes.substr(bytes.size() - 4), path);
    }
  if (std::fflush(file.get()) != 0) throw DeviceError(path.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace gonogo::terrain
