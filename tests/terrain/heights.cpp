// Elevation rasters that would be silently wrong: undeclared voids, other units, pictures, water, far grids.
#include <cmath>
#include <deque>
#include <limits>

#include "base/error.h"
#include "base/math/random.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;
using test::make_raster;
using test::RasterRecipe;

namespace {

constexpr int kSide = 60;

/// Slopes of up to about 20 degrees around `middle` [m], over cells of 10 m; no height is a whole number.
std::vector<float> hills(double middle, double height = 30) {
  std::vector<float> value;
  for (int i = 0; i < kSide * kSide; ++i) {
    const int column = i % kSide, row = i / kSide;
    value.push_back(float(middle + height * std::sin(column / 8.0) * std::cos(row / 9.0) + 0.003 * (i % 7)));
  }
  return value;
}

RasterRecipe recipe_of(std::vector<float> value) {
  return {.columns = kSide, .rows = kSide, .nodata = {}, .value = std::move(value)};
}

RasterSource open(const std::filesystem::path& file, const HeightWish& heights = {}, const GridWish& grid = {}) {
  return RasterSource::open_heights(file, grid, heights);
}

Tile all_of(const RasterSource& source) { return source.read({0, 0, source.grid().columns, source.grid().rows}); }

int holes_in(const Tile& tile) {
  int holes = 0;
  for (const float v : tile.value) holes += std::isnan(v);
  return holes;
}

std::string joined(const std::vector<std::string>& remarks) {
  std::string text;
  for (const std::string& remark : remarks) text += remark + "\n";
  return text;
}

}  // namespace

TEST_CASE("codes that nobody declared are found, left out and named, and nothing else is") {
  const TemporaryFolder folder;
  const float code = GENERATE(-9999.f, -32768.f, -3.4028235e38f, 65535.f, 0.f, -999.f);
  INFO(code);
  std::vector<float> value = hills(1500);
  for (std::size_t row = 20; row < 27; ++row)
    for (std::size_t column = 30; column < 41; ++column) value[row * kSide + column] = code;
  value[5 * kSide + 5] = code;
  make_raster(folder / "dem.tif", recipe_of(value));
  const RasterSource source = open(folder / "dem.tif"), other = source.again();
  REQUIRE(source.remarks().size() == 1);
  CHECK(contains(source.remarks()[0], "78 cells"));
  CHECK(contains(source.remarks()[0], code == 65535.f ? "65535" : code == 0.f ? "hold 0" : "-"));
  const Tile tile = all_of(source);
  CHECK(holes_in(tile) == 78);
  CHECK(std::isnan(tile.at(5, 5)));
  CHECK(tile.at(29, 22) == value[22 * kSide + 29]);
  CHECK(holes_in(all_of(other)) == 78);
}

TEST_CASE("the sea at height 0 is no void where the shore is a shore, and clean ground has no remarks") {
  const TemporaryFolder folder;
  std::vector<float> value = hills(0);
  for (float& v : value) v = std::max(v, 0.f);
  make_raster(folder / "coast.tif", recipe_of(value));
  const RasterSource coast = open(folder / "coast.tif");
  CHECK(holes_in(all_of(coast)) == 0);
  CHECK(contains(joined(coast.remarks()), "exactly one height"));
  make_raster(folder / "hills.tif", recipe_of(hills(300)));
  CHECK(open(folder / "hills.tif").remarks().empty());
}

TEST_CASE("a void is left out before it is warped, so that no neighbour takes part of it") {
  const TemporaryFolder folder;
  std::vector<float> value = hills(1500);
  for (std::size_t row = 20; row < 30; ++row)
    for (std::size_t column = 20; column < 30; ++column) value[row * kSide + column] = -9999;
  make_raster(folder / "dem.tif", {.columns = kSide,
                                   .rows = kSide,
                                   .epsg = 4326,
                                   .transform = {-120.3, 1e-4, 0, 39.4, 0, -1e-4},
                                   .nodata = {},
                                   .value = value});
  const Tile tile = all_of(open(folder / "dem.tif"));
  int holes = 0;
  for (const float v : tile.value) {
    holes += std::isnan(v);
    if (!std::isnan(v)) REQUIRE((v > 1440 && v < 1560));
  }
  CHECK(holes > 60);
}

TEST_CASE("flat areas are those that a flood fill finds") {
  const TemporaryFolder folder;
  const std::uint64_t seed = GENERATE(1u, 2u, 3u);
  constexpr int side = 160;
  // Terraces of smooth noise: many areas of one height, of all sizes and shapes.
  std::vector<float> value;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      double sum = 0;
      for (std::uint64_t k = 0; k < 6; ++k)
        sum += std::sin(column * 0.15 * random_unit(seed, 0, k) + row * 0.15 * random_unit(seed, 1, k) +
                        6 * random_unit(seed, 2, k));
      value.push_back(float(100.25 + 0.37 * std::floor(1.5 * sum)));
    }
  make_raster(folder / "dem.tif", {.columns = side, .rows = side, .nodata = {}, .value = value});
  const RasterSource source = open(folder / "dem.tif");
  const Tile found = source.read_flat({0, 0, side, side});

  // Cells in rows of at least four of one height; what of them hangs together; what of that is large.
  std::vector<char> counts(value.size()), seen(value.size());
  for (int i = 0; i < side * side; ++i) {
    const int column = i % side;
    const float* const row = value.data() + (i - column);
    int left = column, right = column;
    while (left > 0 && row[left - 1] == row[column]) --left;
    while (right < side - 1 && row[right + 1] == row[column]) ++right;
    counts[std::size_t(i)] = right - left + 1 >= 4;
  }
  int flat = 0, areas = 0;
  for (int first = 0; first < side * side; ++first) {
    if (!counts[std::size_t(first)] || seen[std::size_t(first)]) continue;
    std::vector<int> area = {first};
    seen[std::size_t(first)] = 1;
    for (std::size_t k = 0; k < area.size(); ++k)
      for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
        const int x = area[k] % side + dx, y = area[k] / side + dy, next = y * side + x;
        if (x < 0 || y < 0 || x >= side || y >= side || seen[std::size_t(next)] || !counts[std::size_t(next)] ||
            value[std::size_t(next)] != value[std::size_t(first)])
          continue;
        seen[std::size_t(next)] = 1;
        area.push_back(next);
      }
    const bool large = area.size() >= 400;
    areas += large;
    flat += large ? int(area.size()) : 0;
    for (const int cell : area) REQUIRE(bool(found.value[std::size_t(cell)]) == large);
  }
  CHECK(areas > 3);
  int marked = 0;
  for (const float v : found.value) marked += v > 0;
  CHECK(marked == flat);
  CHECK_FALSE(open(folder / "dem.tif", {.unit = "", .flat_is_ground = true}).has_flat());
}

TEST_CASE("whole metres make plains flat, which is no water; a lake among them is found") {
  const TemporaryFolder folder;
  constexpr int side = 200;
  std::vector<float> plain, lake;
  for (int i = 0; i < side * side; ++i) {
    const int column = i % side, row = i / side, height = 300 + column / 40;
    plain.push_back(float(height));
    const bool in_lake = std::hypot(column - 100, row - 100) < 25;  // 1.77 km2
    lake.push_back(in_lake ? 290.f : float(height));
  }
  const auto recipe = [&](const std::vector<float>& value) {
    return RasterRecipe{.columns = side,
                        .rows = side,
                        .transform = {500000, 30, 0, 4400000, 0, -30},
                        .value = value,
                        .type = GDT_Int16};
  };
  make_raster(folder / "plain.tif", recipe(plain));
  CHECK(open(folder / "plain.tif").read_flat({100, 100, 1, 1}).at(0, 0) == 0);
  make_raster(folder / "lake.tif", recipe(lake));
  const RasterSource source = open(folder / "lake.tif");
  CHECK(source.read_flat({100, 100, 1, 1}).at(0, 0) == 1);
  CHECK(source.read_flat({60, 100, 1, 1}).at(0, 0) == 0);  // borders on lower ground
}

TEST_CASE("pictures, classes and complex values are no heights, in one sentence") {
  const TemporaryFolder folder;
  const auto refusal = [&] { return input_error([&] { open(folder / "dem.tif"); }); };
  make_raster(folder / "dem.tif", {.type = GDT_Byte, .bands = 3});
  CHECK(contains(refusal(), "has 3 bands"));
  CHECK(contains(refusal(), "gdal_translate -b 1"));
  make_raster(folder / "dem.tif", {.type = GDT_CFloat32});
  CHECK(contains(refusal(), "complex values (CFloat32)"));
  make_raster(folder / "dem.tif", {.nodata = {}, .type = GDT_Byte});
  GDALDataset* raster = static_cast<GDALDataset*>(GDALOpen((folder / "dem.tif").c_str(), GA_Update));
  GDALColorTable colours;
  const GDALColorEntry entry = {1, 2, 3, 255};
  colours.SetColorEntry(1, &entry);
  raster->GetRasterBand(1)->SetColorTable(&colours);
  GDALClose(raster);
  CHECK(contains(refusal(), "colour table"));
  make_raster(folder / "dem.tif", {});
  make_raster(folder / "land.tif", {.type = GDT_CInt16});
  CHECK(contains(input_error([&] {
                   RasterSource::open_on_grid(folder / "land.tif", open(folder / "dem.tif").grid(),
                                              RasterKind::classes);
                 }),
                 "complex values"));
}

TEST_CASE(
    "the unit of heights comes from the band, the coordinate system or the user, and contradictions are refused") {
  const TemporaryFolder folder;
  const auto file = folder / "dem.tif";
  const auto first = [&](const HeightWish& wish = {}) { return double(open(file, wish).read({3, 3, 1, 1}).at(0, 0)); };
  const std::vector<float> value = hills(100);
  const double stored = double(value[3 * kSide + 3]);
  auto recipe = recipe_of(value);
  make_raster(file, recipe);
  CHECK(first() == Approx(stored));
  CHECK(first({.unit = "ft"}) == Approx(0.3048 * stored));
  CHECK(first({.unit = "us-ft"}) == Approx(1200.0 / 3937.0 * stored).epsilon(1e-7));

  recipe.unit = "ft";
  make_raster(file, recipe);
  CHECK(first() == Approx(0.3048 * stored));
  CHECK(first({.unit = "m"}) == Approx(stored));
  CHECK(contains(joined(open(file, {.unit = "m"}).remarks()), "though it says feet"));

  recipe.unit = "";
  recipe.crs = "EPSG:32610+6360";  // NAVD88 height in US survey feet
  make_raster(file, recipe);
  CHECK(first() == Approx(0.3048 * stored).epsilon(1e-5));
  recipe.unit = "m";
  make_raster(file, recipe);
  const std::string both = input_error([&] { first(); });
  CHECK(contains(both, "its band says that heights are in metres, and its coordinate system that they are in feet"));
  CHECK(first({.unit = "m"}) == Approx(stored));

  recipe.unit = "";
  recipe.crs = "EPSG:2226";  // California zone 2 in US survey feet; no word of heights
  recipe.transform = {6600000, 30, 0, 2000000, 0, -30};
  make_raster(file, recipe);
  CHECK(contains(input_error([&] { first(); }), "its grid is in feet"));
  CHECK(first({.unit = "ft"}) == Approx(0.3048 * stored));
}

TEST_CASE("degrees that are said to be metres are refused with the command that says what they are") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", {.transform = {-122.5, 1e-4, 0, 39.5, 0, -1e-4}});
  CHECK(contains(input_error([&] { open(folder / "dem.tif"); }), "gdal_translate -a_srs EPSG:4326"));
  make_raster(folder / "map.tif", {});
  CHECK(contains(input_error([&] {
                   RasterSource::open_on_grid(folder / "dem.tif", open(folder / "map.tif").grid(), RasterKind::classes);
                 }),
                 "as longitudes and latitudes do"));
  make_raster(folder / "dem.tif",
              {.transform = {0, 0.01, 0, 0.06, 0, -0.01}, .crs = R"(LOCAL_CS["bin",UNIT["metre",1]])"});
  CHECK(open(folder / "dem.tif").grid().cell_width_m() == 0.01);  // a soil bin has no place on the globe
}

TEST_CASE("of two bands the first is read and said, and a transparency that nobody counts is refused") {
  const TemporaryFolder folder;
  const auto with_second = [&](GDALDataType type, GDALColorInterp meaning) {
    make_raster(folder / "dem.tif", {.nodata = {}, .type = type, .bands = 2});
    GDALDataset* raster = static_cast<GDALDataset*>(GDALOpen((folder / "dem.tif").c_str(), GA_Update));
    raster->GetRasterBand(1)->SetDescription("points");
    raster->GetRasterBand(2)->SetDescription("elevation");
    raster->GetRasterBand(2)->SetColorInterpretation(meaning);
    std::vector<float> half(48, 0.f);
    std::fill_n(half.begin(), 24, 255.f);
    if (meaning == GCI_AlphaBand)
      CHECK(raster->GetRasterBand(2)->RasterIO(GF_Write, 0, 0, 8, 6, half.data(), 8, 6, GDT_Float32, 0, 0, nullptr) ==
            CE_None);
    GDALClose(raster);
  };
  with_second(GDT_Float32, GCI_Undefined);
  const std::string remark = joined(open(folder / "dem.tif").remarks());
  CHECK(contains(remark, R"(has two bands; the first, "points", is taken for heights, "elevation" is not read)"));
  CHECK(contains(remark, "gdal_translate -b 2 "));
  with_second(GDT_Float32, GCI_AlphaBand);
  CHECK(contains(input_error([&] { open(folder / "dem.tif"); }), "gdal_translate -b 1 -mask 2 "));
  with_second(GDT_UInt16, GCI_AlphaBand);
  CHECK(holes_in(all_of(open(folder / "dem.tif"))) == 24);
}

TEST_CASE("heights that no ground has are refused unless another unit explains them") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", recipe_of(hills(12000)));
  const std::string refusal = input_error([&] { open(folder / "dem.tif"); });
  CHECK(contains(refusal, "do not occur on the Earth"));
  CHECK(contains(refusal, "\"ft\""));
  CHECK(holes_in(all_of(open(folder / "dem.tif", {.unit = "ft"}))) == 0);
}

TEST_CASE("a grid of another part of the globe is refused with how far off its metres are") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", recipe_of(hills(500)));  // zone 10
  const auto refusal = [&](const char* crs) {
    return input_error([&] { open(folder / "dem.tif", {}, {.crs = crs, .cell_size = 0}); });
  };
  CHECK(open(folder / "dem.tif", {}, {.crs = "EPSG:32611", .cell_size = 0}).grid().crs_code == "EPSG:32611");
  CHECK(contains(refusal("EPSG:32615"), "another part of the globe"));
  CHECK(contains(refusal("EPSG:3857"), "% off those of the ground"));  // 1 / cos 39.7 degrees
  CHECK(contains(refusal("EPSG:32733"), "another part of the globe"));
}
