// Region files from soil rasters: the texture triangle, units of the publishers, mixtures by error, and bad input.
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/files/file.h"
#include "base/math/random.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/soil_grids/make_region.h"
#include "pipeline/map/soil_grids/soil_cells.h"
#include "terrain/raster/raster_source.h"
#include "terrain/soil/soil.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::map;
using terrain::RasterSource;
using terrain::usda_texture;

namespace {

struct Corner {
  double sand, clay;
};

/// Outlines of the classes as the triangle of the Soil Survey Manual draws them.
const std::map<std::string, std::vector<Corner>> kOutline = {
    {"clay", {{0, 100}, {0, 60}, {20, 40}, {45, 40}, {45, 55}}},
    {"silty clay", {{0, 60}, {0, 40}, {20, 40}}},
    {"sandy clay", {{45, 55}, {45, 35}, {65, 35}}},
    {"clay loam", {{20, 40}, {20, 27}, {45, 27}, {45, 40}}},
    {"silty clay loam", {{0, 40}, {0, 27}, {20, 27}, {20, 40}}},
    {"sandy clay loam", {{45, 35}, {45, 27}, {52, 20}, {80, 20}, {65, 35}}},
    {"loam", {{45, 27}, {23, 27}, {43, 7}, {52, 7}, {52, 20}}},
    {"silt loam", {{0, 27}, {0, 12}, {8, 12}, {20, 0}, {50, 0}, {43, 7}, {23, 27}}},
    {"sandy loam", {{52, 20}, {52, 7}, {43, 7}, {50, 0}, {70, 0}, {85, 15}, {80, 20}}},
    {"silt", {{0, 12}, {0, 0}, {20, 0}, {8, 12}}},
    {"loamy sand", {{70, 0}, {85, 0}, {90, 10}, {85, 15}}},
    {"sand", {{85, 0}, {100, 0}, {90, 10}}}};

bool holds(const std::vector<Corner>& outline, double sand, double clay) {
  bool inside = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Corner a = outline[i], b = outline[j];
    if ((a.clay > clay) != (b.clay > clay) && sand < (b.sand - a.sand) * (clay - a.clay) / (b.clay - a.clay) + a.sand)
      inside = !inside;
  }
  return inside;
}

constexpr int kCells = 8;

/// One soil layer of 8 x 8 cells of 40 m: `west` in its western half, `east` in its eastern one.
void layer(const TemporaryFolder& folder, const std::string& name, float west, float east,
           std::array<double, 6> transform = {500000, 40, 0, 4400000, 0, -40}) {
  std::vector<float> value;
  for (int i = 0; i < kCells * kCells; ++i) value.push_back(i % kCells < kCells / 2 ? west : east);
  test::make_raster(folder / name,
                    {.columns = kCells, .rows = kCells, .transform = transform, .nodata = -32768, .value = value});
}

void elevation(const TemporaryFolder& folder, const std::string& name = "elevation.tif") {
  test::make_raster(folder / name, {.columns = 32, .rows = 32});
}

/// Sand in the west and loam in the east, in the units of SoilGrids.
void soil_grids(const TemporaryFolder& folder) {
  elevation(folder);
  layer(folder, "sand_0-5cm_mean.tif", 900, 400);
  layer(folder, "silt_0-5cm_mean.tif", 50, 400);
  layer(folder, "clay_0-5cm_mean.tif", 50, 200);
}

RegionMakeRequest exact(const TemporaryFolder& folder) { return {.folder = folder.path(), .texture_error = 0}; }

std::string refusal(const TemporaryFolder& folder) {
  return input_error([&] { make_region(exact(folder)); });
}

terrain::Tile read(const std::filesystem::path& file) {
  const RasterSource source = RasterSource::open_as_it_lies(file);
  return source.read({0, 0, source.grid().columns, source.grid().rows});
}

bool has_remark(const RegionMade& made, const std::string& part) {
  for (const std::string& remark : made.remarks)
    if (contains(remark, part)) return true;
  return false;
}

}  // namespace

TEST_CASE("every point of the triangle has the class whose outline in the manual holds it") {
  int points = 0;
  for (double sand = 0.37; sand < 100; sand += 0.7)
    for (double clay = 0.16; sand + clay < 100; clay += 0.7) {
      const std::string texture = usda_texture(sand, 100 - sand - clay, clay);
      INFO(sand << " " << clay << " " << texture);
      REQUIRE(holds(kOutline.at(texture), sand, clay));
      ++points;
    }
  CHECK(points > 9000);
}

TEST_CASE("parts of a mixture are the shares of classes under normal errors") {
  const TextureShares s{.sand = 50, .silt = 32, .clay = 18, .sand_error = 9, .clay_error = 5};
  const TextureMixture mixture = texture_mixture(s, 8);
  std::map<std::string, double> share;
  constexpr int draws = 40000;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const auto normal = [&](std::uint64_t k) {
      return std::sqrt(-2 * std::log1p(-random_unit(3, k, i))) * std::cos(2 * M_PI * random_unit(4, k, i));
    };
    const double sand = std::clamp(s.sand + s.sand_error * normal(0), 0.0, 100.0);
    const double clay = std::clamp(s.clay + s.clay_error * normal(1), 0.0, 100 - sand);
    share[usda_texture(sand, 100 - sand - clay, clay)] += 8.0 / draws;
  }
  int sum = 0;
  for (std::size_t t = 0; t < mixture.size(); ++t) {
    INFO(terrain::usda_texture_codes()[t]);
    CHECK(std::abs(mixture[t] - share[terrain::usda_texture_codes()[t]]) < 1);
    sum += mixture[t];
  }
  CHECK(sum == 8);
  CHECK(texture_mixture({.sand = 92, .silt = 5, .clay = 3}, 8)[0] == 8);  // no error: one class
}

TEST_CASE("SoilGrids layers become textures, water by mass and a region that reads") {
  const TemporaryFolder folder;
  soil_grids(folder);
  layer(folder, "bdod_0-5cm_mean.tif", 150, 120);    // 1.5 and 1.2 g/cm3
  layer(folder, "wv0033_0-5cm_mean.tif", 150, 360);  // 15 and 36 % by volume
  layer(folder, "sand_60-100cm_mean.tif", 0, 0);
  const RegionMade made = make_region(exact(folder));
  CHECK(made.soils == 2);
  CHECK(has_remark(made, "sand_60-100cm_mean.tif lies deeper than 30 cm"));
  CHECK(has_remark(made, "suction of 33 kPa"));
  const terrain::Tile water = read(folder / "water.tif"), code = read(folder / "soil_class.tif");
  CHECK(water.at(0, 3) == Approx(10));
  CHECK(water.at(7, 3) == Approx(30));
  CHECK(code.at(0, 0) != code.at(7, 0));
  const Region region = read_region(made.files.front());
  REQUIRE(region.soils.size() == 2);
  for (const Soil& soil : region.soils) {
    const std::string texture = float(soil.code) == code.at(0, 0) ? "sand" : "loam";
    CHECK(soil.name == "8 " + texture);
    for (const SoilSample& sample : soil.samples) CHECK(sample.texture == texture);
    CHECK(samples_in(soil, region.moistures.at(0)).size() * 3 == soil.samples.size());  // dry, of dry, moist and wet
    for (const SoilSample& sample : samples_in(soil, region.moistures.at(2))) CHECK(sample.moisture == "wet");
  }
}

TEST_CASE("5 and 95 % points are errors, and layers of the upper 30 cm count by their thickness") {
  const TemporaryFolder folder;
  soil_grids(folder);
  layer(folder, "sand_0-5cm_Q0.05.tif", 900, 252);
  layer(folder, "sand_0-5cm_Q0.95.tif", 900, 548);  // 9 % standard error in the east
  layer(folder, "clay_0-5cm_Q0.05.tif", 50, 118);
  layer(folder, "clay_0-5cm_Q0.95.tif", 50, 282);
  make_region(exact(folder));
  const std::string text = read_file(folder / "region.json");
  CHECK(contains(text, "\"sand\": 8"));
  CHECK(contains(text, "\"loam\": 6"));  // at 19 of the 25 points, 4 are silt loam and 2 sandy clay loam
  CHECK(contains(text, "\"silt loam\": 1"));
  CHECK(contains(text, "\"sandy clay loam\": 1"));
  layer(folder, "sand_15-30cm_mean.tif", 900, 800);  // with 15 cm it weighs three times the upper 5 cm
  layer(folder, "silt_15-30cm_mean.tif", 50, 100);
  layer(folder, "clay_15-30cm_mean.tif", 50, 100);
  for (const char* q : {"sand_0-5cm_Q0.05.tif", "sand_0-5cm_Q0.95.tif", "clay_0-5cm_Q0.05.tif", "clay_0-5cm_Q0.95.tif"})
    std::filesystem::remove(folder / q);
  make_region(exact(folder));  // 70 % sand and 12.5 % clay
  CHECK(contains(read_file(folder / "region.json"), "\"sandy loam\": 8"));
}

TEST_CASE("SSURGO columns are per cent, and map units take their rows from mukey.csv") {
  const TemporaryFolder folder;
  elevation(folder);
  layer(folder, "sandtotal_r.tif", 90, 40);
  layer(folder, "claytotal_r.tif", 5, 20);
  make_region(exact(folder));
  const std::string by_columns = read_file(folder / "region.json");
  CHECK(contains(by_columns, "\"loam\": 8"));
  std::filesystem::remove(folder / "sandtotal_r.tif");
  std::filesystem::remove(folder / "claytotal_r.tif");
  layer(folder, "mukey.tif", 2600481, 2600482);
  write_file_atomically(folder / "mukey.csv",
                        "mukey,muname,sandtotal_r,claytotal_r\n2600481,A,90,5\n2600482,B,40,20\n");
  make_region(exact(folder));
  CHECK(read_file(folder / "region.json") == by_columns);
  write_file_atomically(folder / "mukey.csv", "mukey,sandtotal_r,claytotal_r\n2600481,90,5\n");
  CHECK(has_remark(make_region(exact(folder)), "50.0 % of the soil's cells have no data"));
  write_file_atomically(folder / "mukey.csv", "mukey,sandtotal_r,claytotal_r\n7,90,5\n7,40,20\n");
  CHECK(contains(refusal(folder), "mukey.csv: line 3: mukey 7 is given twice"));
  write_file_atomically(folder / "mukey.csv", "mukey,sandtotal_r,claytotal_r\n7,much,5\n");
  CHECK(contains(refusal(folder), "line 2: sandtotal_r: \"much\" is not a number"));
  write_file_atomically(folder / "mukey.csv", "key,sandtotal_r,claytotal_r\n7,90,5\n");
  CHECK(contains(refusal(folder), "has no column mukey"));
  std::filesystem::remove(folder / "mukey.csv");
  CHECK(contains(refusal(folder), "mukey.csv is not there"));
}

TEST_CASE("folders and layers that cannot be used are refused in a sentence") {
  const TemporaryFolder folder;
  CHECK(contains(input_error([&] { make_region({.folder = folder / "nowhere"}); }), "nowhere: no such folder"));
  CHECK(contains(refusal(folder), "holds no elevation raster"));
  elevation(folder);
  CHECK(contains(refusal(folder), "holds 0 of sand, silt and clay, and two are needed"));
  layer(folder, "sand_0-5cm_mean.tif", 900, 400);
  CHECK(contains(refusal(folder), "holds 1 of sand, silt and clay"));
  layer(folder, "clay_0-5cm_Q0.05.tif", 50, 50);
  CHECK(contains(refusal(folder), "low or high value without the middle one"));
  soil_grids(folder);
  elevation(folder, "other.tif");
  CHECK(make_region(exact(folder)).soils == 2);  // elevation.tif is named so
  elevation(folder, "dem.tif");
  CHECK(contains(refusal(folder), "is the elevation?"));
  std::filesystem::remove(folder / "dem.tif");
  std::filesystem::remove(folder / "other.tif");
  layer(folder, "sandtotal_r.tif", 90, 40);
  CHECK(contains(refusal(folder), "keep the layers of one publisher"));
  std::filesystem::remove(folder / "sandtotal_r.tif");
  layer(folder, "clay_0-5cm_mean.tif", 5000, 200);
  CHECK(contains(refusal(folder), "clay_0-5cm_mean.tif: holds 5000, and g/kg allows 0 to 1000"));
  layer(folder, "clay_0-5cm_mean.tif", -7, 200);
  CHECK(contains(refusal(folder), "holds -7"));
  layer(folder, "sand_0-5cm_mean.tif", 90, 40);  // per cent under a name of SoilGrids
  layer(folder, "silt_0-5cm_mean.tif", 5, 40);
  layer(folder, "clay_0-5cm_mean.tif", 5, 20);
  CHECK(contains(refusal(folder), "add up to 10 % in the mean"));
  for (const char* name : {"sand_0-5cm_mean.tif", "silt_0-5cm_mean.tif", "clay_0-5cm_mean.tif"})
    layer(folder, name, 0, 0);
  CHECK(contains(refusal(folder), "no cell has values of sand, silt and clay"));
  soil_grids(folder);
  CHECK(contains(input_error([&] { make_region({.folder = folder.path(), .suction = 33}); }),
                 "holds no water content at 33 kPa"));
  layer(folder, "wv0010_0-5cm_mean.tif", 150, 360);
  CHECK(has_remark(make_region(exact(folder)), "no bulk density"));
  for (const char* name : {"sand_0-5cm_mean.tif", "silt_0-5cm_mean.tif", "clay_0-5cm_mean.tif"})
    layer(folder, name, 300, 300, {900000, 40, 0, 4400000, 0, -40});
  std::filesystem::remove(folder / "wv0010_0-5cm_mean.tif");
  CHECK(contains(refusal(folder), "does not overlap"));
}

TEST_CASE("a mixture of a region file names textures and parts") {
  const TemporaryFolder folder;
  elevation(folder);
  layer(folder, "codes.tif", 1, 1);
  const auto refused = [&](const std::string& mixture) {
    write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "r", "rasters": [
      {"role": "elevation", "file": "elevation.tif", "source": "s", "licence": "l"},
      {"role": "soil_class", "file": "codes.tif", "source": "s", "licence": "l"}],
      "soils": [{"code": 1, "name": "m", "mixture": )" +
                                                      mixture + "}]}");
    return input_error([&] { read_region(folder / "region.json"); });
  };
  CHECK(contains(refused(R"({"sandy lome": 3})"), "did you mean \"sandy loam\"?"));
  CHECK(contains(refused(R"({"sand": 0})"), "sand: value 0 is outside the allowed range"));
  CHECK(contains(refused(R"({"sand": 40, "loam": 40})"), "has 80 parts, allowed are 1 to 64"));
  CHECK(contains(refused(R"({})"), "has 0 parts"));
}
