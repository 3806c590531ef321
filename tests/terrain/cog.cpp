// Cloud-optimised GeoTIFFs by the rules of GDAL's validate_cloud_optimized_geotiff.py, read byte by byte here, and by
// GDAL itself.
#include "terrain/raster/layer/cog.h"

#include <gdal_rat.h>

#include <cmath>
#include <cstring>
#include <map>

#include "base/files/file.h"
#include "base/math/random.h"
#include "terrain/raster/layer/geotiff.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;

namespace {

struct Directory {
  std::uint64_t at = 0;
  std::map<int, std::vector<std::uint64_t>> tag;  // of integer types
};

template <class T>
T get(const std::string& bytes, std::uint64_t at) {
  T value{};
  REQUIRE(at + sizeof value <= bytes.size());
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Directories of a classic little-endian TIFF.
std::vector<Directory> directories(const std::string& bytes) {
  REQUIRE(bytes.substr(0, 2) == "II");
  REQUIRE(get<std::uint16_t>(bytes, 2) == 42);
  std::vector<Directory> list;
  for (std::uint64_t at = get<std::uint32_t>(bytes, 4); at != 0;) {
    REQUIRE(at % 2 == 0);
    Directory directory{at, {}};
    const int entries = get<std::uint16_t>(bytes, at);
    int last = 0;
    for (int i = 0; i < entries; ++i) {
      const std::uint64_t entry = at + 2 + 12 * std::uint64_t(i);
      const int tag = get<std::uint16_t>(bytes, entry), type = get<std::uint16_t>(bytes, entry + 2);
      REQUIRE(tag > last);  // ascending, TIFF 6.0
      last = tag;
      const std::uint32_t count = get<std::uint32_t>(bytes, entry + 4);
      const std::size_t size = type == 3 ? 2 : 4;
      if (type != 3 && type != 4) continue;
      const std::uint64_t from = size * count <= 4 ? entry + 8 : get<std::uint32_t>(bytes, entry + 8);
      for (std::uint32_t k = 0; k < count; ++k)
        directory.tag[tag].push_back(size == 2 ? get<std::uint16_t>(bytes, from + 2 * k)
                                               : get<std::uint32_t>(bytes, from + 4 * k));
    }
    list.push_back(directory);
    at = get<std::uint32_t>(bytes, at + 2 + 12 * std::uint64_t(entries));
  }
  return list;
}

Tile random_tile(int columns, int rows, bool classes) {
  Tile tile(columns, rows, 0);
  for (std::size_t i = 0; i < tile.value.size(); ++i) {
    const double u = random_unit(3, classes, i);
    tile.value[i] = u < 0.1 ? std::nanf("") : classes ? float(1 + int(4 * u)) : float(u * u);
  }
  return tile;
}

LayerInfo info(bool classes, bool smooth = false) {
  return {.name = classes ? "class" : "P(go)",
          .unit = classes ? "" : "1",
          .classes = classes,
          .legend = {{1, "one", "#ff0000"}, {4, "four", "#00ff00"}},
          .metadata = {{"GONOGO_rules", "<a> & \"b\""}},
          .smooth = smooth};
}

}  // namespace

TEST_CASE("a layer keeps every rule of a cloud-optimised GeoTIFF") {
  const bool classes = GENERATE(true, false);
  const TemporaryFolder folder;
  constexpr int columns = 1300, rows = 1100;
  test::make_raster(folder / "grid.tif", {.columns = columns, .rows = rows});
  GeoTiffWriter writer(folder / "layer.tif", RasterSource::open_elevation(folder / "grid.tif").grid(), info(classes));
  writer.write({0, 0, columns, rows}, random_tile(columns, rows, classes));
  writer.finish(2);
  const std::string bytes = read_file(folder / "layer.tif");
  const std::vector<Directory> list = directories(bytes);
  REQUIRE(list.size() == 3);  // 1300, 650, 325
  CHECK(bytes.substr(8, 30) == "GDAL_STRUCTURAL_METADATA_SIZE=");
  std::uint64_t end = bytes.size();
  for (std::size_t l = 0; l < list.size(); ++l) {
    const auto& tag = list[l].tag;
    CHECK(tag.at(254)[0] == (l > 0 ? 1u : 0u));
    CHECK(tag.at(256)[0] == std::uint64_t((columns + (1 << l) - 1) >> l));
    CHECK(tag.at(322)[0] == 512);
    if (l > 0) CHECK(list[l].at > list[l - 1].at);
    CHECK(list[l].at < list.back().tag.at(324)[0]);  // every directory before any tile
    const auto &offset = tag.at(324), &size = tag.at(325);
    CHECK(offset.size() == tag.at(325).size());
    for (std::size_t t = 0; t < offset.size(); ++t) {
      if (t > 0) CHECK(offset[t] == offset[t - 1] + size[t - 1] + 8);                           // row by row
      CHECK(get<std::uint32_t>(bytes, offset[t] - 4) == size[t]);                               // leader
      CHECK(bytes.substr(offset[t] + size[t], 4) == bytes.substr(offset[t] + size[t] - 4, 4));  // trailer
    }
    CHECK(offset.back() + size.back() + 4 == end);  // smaller levels lie before larger ones
    end = offset.front() - 4;
  }
}

TEST_CASE("GDAL reads back every cell and every overview of a layer, with a predictor and without") {
  const int kind = GENERATE(0, 1, 2);
  const bool classes = kind == 0, smooth = kind == 2;
  const TemporaryFolder folder;
  constexpr int columns = 1300, rows = 1100;
  test::make_raster(folder / "grid.tif", {.columns = columns, .rows = rows});
  const Tile tile = random_tile(columns, rows, classes);
  GeoTiffWriter writer(folder / "layer.tif", RasterSource::open_elevation(folder / "grid.tif").grid(),
                       info(classes, smooth));
  writer.write({0, 0, columns, rows}, tile);
  writer.finish(1);
  GDALDataset* raster = GDALDataset::Open((folder / "layer.tif").c_str());
  REQUIRE(raster);
  GDALRasterBand& band = *raster->GetRasterBand(1);
  CHECK(std::string(raster->GetMetadataItem("GONOGO_rules")) == "<a> & \"b\"");
  const float nodata = classes ? 255 : -9999;
  std::vector<float> level(tile.value);
  for (float& v : level)
    if (std::isnan(v)) v = nodata;
  int width = columns, height = rows;
  for (int o = -1; o < band.GetOverviewCount(); ++o) {
    GDALRasterBand& here = o < 0 ? band : *band.GetOverview(o);
    REQUIRE(here.GetXSize() == width);
    REQUIRE(here.GetYSize() == height);
    std::vector<float> read(std::size_t(width) * std::size_t(height));
    REQUIRE(here.RasterIO(GF_Read, 0, 0, width, height, read.data(), width, height, GDT_Float32, 0, 0, nullptr) ==
            CE_None);
    REQUIRE(read == level);
    // The next level, straight from the rule.
    const int w = (width + 1) / 2, h = (height + 1) / 2;
    std::vector<float> next;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        std::vector<float> valid;
        for (int b = 2 * y; b < std::min(2 * y + 2, height); ++b)
          for (int a = 2 * x; a < std::min(2 * x + 2, width); ++a)
            if (const float v = level[std::size_t(b) * std::size_t(width) + std::size_t(a)]; v != nodata)
              valid.push_back(v);
        float best = nodata, sum = 0;
        long best_count = 0;
        for (const float v : valid) {
          sum += v;
          const long count = std::count(valid.begin(), valid.end(), v);
          if (count > best_count || (count == best_count && v > best)) {
            best_count = count;
            best = v;
          }
        }
        next.push_back(valid.empty() ? nodata : classes ? best : sum / float(valid.size()));
      }
    level = next;
    width = w;
    height = h;
  }
  if (classes) {
    const GDALRasterAttributeTable* table = band.GetDefaultRAT();
    REQUIRE(table);
    REQUIRE(table->GetRowCount() == 2);
    CHECK(std::string(table->GetValueAsString(1, 1)) == "four");
    CHECK(table->GetValueAsInt(0, 2) == std::count(tile.value.begin(), tile.value.end(), 1.0f));
    CHECK(table->GetColOfUsage(GFU_Red) == 3);
  }
  GDALClose(raster);
}

TEST_CASE("tiles of an unfinished layer are found again by a writer of the same key") {
  const TemporaryFolder folder;
  test::make_raster(folder / "grid.tif", {.columns = 1100, .rows = 600});
  const MapGrid grid = RasterSource::open_elevation(folder / "grid.tif").grid();
  const Tile tile = random_tile(512, 512, false);
  { GeoTiffWriter(folder / "a.tif", grid, info(false), "key").write({512, 0, 512, 512}, tile); }
  const GeoTiffWriter again(folder / "a.tif", grid, info(false), "key");
  CHECK(again.has_tile(512, 0));
  CHECK(again.has_tile(700, 100));
  CHECK_FALSE(again.has_tile(0, 0));
  CHECK_FALSE(GeoTiffWriter(folder / "a.tif", grid, info(false), "other").has_tile(512, 0));
}
