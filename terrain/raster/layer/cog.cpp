#include "terrain/raster/layer/cog.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <ogr_spatialref.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "terrain/raster/file/deflate.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace {

static_assert(std::endian::native == std::endian::little, "tiles are written in this machine's order of bytes");

constexpr int kLevel = 1;  // of DEFLATE. Level 6 takes three times the time and makes layers 6 % smaller

template <class Cell>
std::string packed(const std::vector<Cell>& cells) {
  return deflated(cells.data(), cells.size() * sizeof(Cell), kLevel);
}

template <class Cell>
void unpack(std::string_view bytes, std::vector<Cell>& out, const std::string& where) {
  if (!inflate(bytes, out.data(), out.size() * sizeof(Cell)))
    throw DeviceError(where + ": a tile of the unfinished map is damaged; remove the file and start again");
}

constexpr std::size_t kRowBytes = 4 * kTileCells;  // of floats

/// Each row's bytes are sorted by weight, the highest first, and then differenced.
std::vector<std::uint8_t> predicted(const std::vector<float>& cells) {
  std::vector<std::uint8_t> bytes(4 * cells.size());
  std::uint8_t planes[kRowBytes];
  for (std::size_t row = 0; row < kTileArea; row += kTileCells) {
    for (std::size_t i = 0; i < kTileCells; ++i) {
      const auto word = std::bit_cast<std::uint32_t>(cells[row + i]);
      for (std::size_t b = 0; b < 4; ++b) planes[b * kTileCells + i] = std::uint8_t(word >> (24 - 8 * b));
    }
    std::uint8_t* out = &bytes[4 * row];
    out[0] = planes[0];
    for (std::size_t i = 1; i < kRowBytes; ++i) out[i] = std::uint8_t(planes[i] - planes[i - 1]);
  }
  return bytes;
}

void undo_prediction(std::vector<std::uint8_t> planes, std::vector<float>& cells) {
  for (std::size_t row = 0; row < kTileArea; row += kTileCells) {
    std::uint8_t* in = &planes[4 * row];
    for (std::size_t i = 1; i < kRowBytes; ++i) in[i] = std::uint8_t(in[i] + in[i - 1]);
    for (std::size_t i = 0; i < kTileCells; ++i) {
      std::uint32_t word = 0;
      for (std::size_t b = 0; b < 4; ++b) word = (word << 8) | in[b * kTileCells + i];
      cells[row + i] = std::bit_cast<float>(word);
    }
  }
}

}  // namespace

std::string encode_tile(const std::vector<std::uint8_t>& cells, bool) { return packed(cells); }

std::string encode_tile(const std::vector<float>& cells, bool smooth) {
  return smooth ? packed(predicted(cells)) : packed(cells);
}

void decode_tile(std::string_view bytes, std::vector<std::uint8_t>& cells, bool, const std::string& where) {
  cells.resize(kTileArea);
  unpack(bytes, cells, where);
}

void decode_tile(std::string_view bytes, std::vector<float>& cells, bool smooth, const std::string& where) {
  cells.resize(kTileArea);
  if (!smooth) return unpack(bytes, cells, where);
  std::vector<std::uint8_t> planes(4 * kTileArea);
  unpack(bytes, planes, where);
  undo_prediction(std::move(planes), cells);
}

namespace {

struct TiffTag {
  std::uint16_t tag = 0, type = 0;
  std::uint64_t count = 0;
  std::string data;  // values in little-endian order
};

constexpr std::uint16_t kColourMap = 320, kGdalNoData = 42113;

// Software, colour map, GeoTIFF (OGC 19-008) and GDAL's own.
constexpr std::array<std::uint16_t, 10> kDescribing = {305,   kColourMap, 33550, 33922, 34264,
                                                       34735, 34736,      34737, 42112, kGdalNoData};

/// A setting of GDAL for this thread, put back when it leaves.
class ThreadOption {
 public:
  ThreadOption(const char* key, const char* value) : key_(key) {
    if (const char* old = CPLGetThreadLocalConfigOption(key, nullptr)) {
      old_ = old;
      had_ = true;
    }
    CPLSetThreadLocalConfigOption(key, value);
  }
  ~ThreadOption() { CPLSetThreadLocalConfigOption(key_, had_ ? old_.c_str() : nullptr); }

 private:
  const char* key_;
  std::string old_;
  bool had_ = false;
};

GDALColorEntry colour_entry(const std::string& colour) {
  unsigned red = 0, green = 0, blue = 0;
  std::sscanf(colour.c_str(), "#%2x%2x%2x", &red, &green, &blue);
  return {short(red), short(green), short(blue), 255};
}

void describe_band(GDALDataset& dataset, const LayerInfo& info) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  band.SetDescription(info.name.c_str());
  band.SetNoDataValue(info.classes ? kClassNoData : kFloatNoData);
  if (!info.unit.empty()) band.SetUnitType(info.unit.c_str());
  for (const auto& [key, value] : info.metadata) dataset.SetMetadataItem(key.c_str(), value.c_str());
  if (!info.classes) return;
  GDALColorTable table;
  for (int value = 0; value < 256; ++value) {
    const GDALColorEntry clear = {0, 0, 0, 0};
    table.SetColorEntry(value, &clear);
  }
  std::string legend;
  for (const LegendEntry& entry : info.legend) {
    const GDALColorEntry colour = colour_entry(entry.colour);
    table.SetColorEntry(int(entry.value), &colour);
    legend += (legend.empty() ? "" : "; ") + std::to_string(int(entry.value)) + " " + entry.label;
  }
  band.SetColorTable(&table);
  band.SetColorInterpretation(GCI_PaletteIndex);
  dataset.SetMetadataItem("LEGEND", legend.c_str());
}

void make_template(const std::string& name, const MapGrid& grid, const LayerInfo& info) {
  GdalCall call;
  const ThreadOption no_sidecar("GDAL_PAM_ENABLED", "NO");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  DatasetHandle dataset(driver->Create(name.c_str(), 1, 1, 1, info.classes ? GDT_Byte : GDT_Float32, nullptr));
  if (!dataset) throw DeviceError("GDAL cannot describe a layer (" + call.message() + ")");
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  dataset->SetGeoTransform(transform);
  OGRSpatialReference crs;
  crs.importFromWkt(grid.crs_wkt.c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  dataset->SetSpatialRef(&crs);
  dataset->SetMetadataItem("AREA_OR_POINT", "Area");
  describe_band(*dataset, info);
}

std::size_t bytes_of(std::uint16_t type) {
  constexpr std::array<std::size_t, 13> kBytes = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8};  // TIFF 6.0, section 2
  return type < kBytes.size() ? kBytes[type] : 0;
}

template <class T>
T get(const std::string& file, std::size_t at) {
  T value{};
  if (at + sizeof value > file.size()) throw DeviceError("GDAL made a GeoTIFF that cannot be understood");
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

std::vector<TiffTag> first_directory(const std::string& file) {
  if (file.substr(0, 2) != "II" || get<std::uint16_t>(file, 2) != 42)
    throw DeviceError("GDAL made a GeoTIFF that is no classic little-endian one");
  const std::size_t at = get<std::uint32_t>(file, 4);
  std::vector<TiffTag> tags;
  for (std::size_t i = 0; i < get<std::uint16_t>(file, at); ++i) {
    const std::size_t entry = at + 2 + 12 * i;
    TiffTag tag{get<std::uint16_t>(file, entry), get<std::uint16_t>(file, entry + 2),
                get<std::uint32_t>(file, entry + 4), ""};
    const std::size_t size = bytes_of(tag.type) * tag.count;
    const std::size_t where = size <= 4 ? entry + 8 : get<std::uint32_t>(file, entry + 8);
    if (where + size > file.size()) throw DeviceError("GDAL made a GeoTIFF that cannot be understood");
    tag.data = file.substr(where, size);
    tags.push_back(std::move(tag));
  }
  return tags;
}

/// The tags that describe a layer: place, coordinate system, colours, nodata, names, metadata. GDAL writes them into a
/// GeoTIFF in memory, and they are copied from there, so that the encoding is GDAL's.
std::vector<TiffTag> describing_tags(const MapGrid& grid, const LayerInfo& info) {
  static std::atomic<unsigned> count = 0;
  const std::string name = "/vsimem/gonogo_layer_" + std::to_string(count++) + ".tif";
  make_template(name, grid, info);
  vsi_l_offset size = 0;
  const auto* bytes = VSIGetMemFileBuffer(name.c_str(), &size, FALSE);
  if (!bytes) throw DeviceError("GDAL cannot describe a layer");
  const std::string file(reinterpret_cast<const char*>(bytes), size);
  VSIUnlink(name.c_str());
  std::vector<TiffTag> tags;
  for (TiffTag& tag : first_directory(file))
    if (std::find(kDescribing.begin(), kDescribing.end(), tag.tag) != kDescribing.end()) tags.push_back(std::move(tag));
  return tags;
}

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
                               number(317, kShort, {info.smooth ? 3u : 1u}),  // predictor
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
