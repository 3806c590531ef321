// Whole maps of small made ground and of the sample region, with a model known in closed form.
#include "pipeline/map/write/make_map.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "terrain/raster/layer/slope.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/pipeline/map/strips.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
using test::AnalyticModel;

namespace {

constexpr int kColumns = 64, kRows = 40;

/// Ground whose slope grows eastward: the steepness of column c is about c degrees. One nodata cell.
std::vector<float> bowl() {
  std::vector<float> height;
  double z = 2000;
  for (int column = 0; column < kColumns; ++column) {
    height.push_back(float(z));
    z += 10 * std::tan(to_radians(column + 0.5));
  }
  std::vector<float> value;
  for (int row = 0; row < kRows; ++row) value.insert(value.end(), height.begin(), height.end());
  value[20 * kColumns + 10] = -9999;
  return value;
}

/// Soil 4 in the north, 9 (not in the table) in the middle, nodata in the south; 30 m cells.
std::vector<float> soil_codes() {
  std::vector<float> codes;
  for (int row = 0; row < 14; ++row)
    for (int column = 0; column < 22; ++column) codes.push_back(row < 8 ? 4.0f : row < 11 ? 9.0f : 255.0f);
  return codes;
}

MapRequest small_request(const TemporaryFolder& folder, const std::string& out = "map") {
  test::make_raster(folder / "dem.tif", {.columns = kColumns, .rows = kRows, .value = bowl()});
  test::make_raster(folder / "soil.tif", {.columns = 22,
                                          .rows = 14,
                                          .transform = {500000, 30, 0, 4400000, 0, -30},
                                          .nodata = 255,
                                          .value = soil_codes(),
                                          .type = GDT_Byte});
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "made ground",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none"},
                {"role": "soil_class", "file": "soil.tif", "source": "made", "licence": "none"}],
    "soils": [{"code": 4, "name": "loam", "texture": "loam",
      "samples": [{"friction_angle": 28, "cohesion": 0, "source": "made"}]}]})");
  MapRequest request;
  request.model = AnalyticModel{}.outcome_model();
  request.region = read_region(folder / "region.json");
  request.out = folder / out;
  return request;
}

const AnalyticModel kSagehenModel = {.weaker_deg = 12};  // go, slow-go and no-go all occur

MapRequest sagehen_request(const std::filesystem::path& out) {
  MapRequest request;
  request.model = kSagehenModel.outcome_model();
  request.region = read_region(GONOGO_SOURCE_DIR "/configs/regions/sagehen.json");
  request.out = out;
  return request;
}

/// A layer as written, not-a-number where nodata.
Tile layer(const std::filesystem::path& file, const std::filesystem::path& elevation) {
  const terrain::MapGrid grid = RasterSource::open_elevation(elevation).grid();
  return RasterSource::open_on_grid(file, grid, RasterKind::classes).read({0, 0, grid.columns, grid.rows});
}

}  // namespace

TEST_CASE("every cell of made ground gets the class that its slope and soil ask for") {
  const TemporaryFolder folder;
  const MapRequest request = small_request(folder);
  const MapSummary summary = make_map(request);
  const Tile verdict = layer(folder / "map/go.tif", folder / "dem.tif"),
             reason = layer(folder / "map/reason.tif", folder / "dem.tif");
  const Tile p_go = layer(folder / "map/p_go.tif", folder / "dem.tif");
  const AnalyticModel model;
  int compared = 0;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      INFO("column " << column << ", row " << row);
      const bool border = row == 0 || column == 0 || row == kRows - 1 || column == kColumns - 1;
      const bool hole = std::abs(row - 20) <= 1 && std::abs(column - 10) <= 1;
      REQUIRE(std::isnan(verdict.at(column, row)) == (border || hole));
      if (border || hole) continue;
      if (row >= 24) {  // the soil raster's row 8 starts at 240 m: a code without a meaning, then nodata
        REQUIRE(verdict.at(column, row) == int(Verdict::unknown));
        REQUIRE(reason.at(column, row) == int(Reason::input_missing));
        continue;
      }
      // Central difference of the two bowl steps next to the cell, independent of Horn's weights on straight contours.
      const double west = std::tan(to_radians(column - 0.5)), east = std::tan(to_radians(column + 0.5));
      const double slope = to_degrees(std::atan((west + east) / 2));
      if (std::abs(slope - 35) < 0.1) continue;
      const double p = model.p_go(slope, 28, 0);
      if (slope > 35) {
        REQUIRE(verdict.at(column, row) == int(Verdict::no_go));
        REQUIRE(std::isnan(p_go.at(column, row)));
      } else {
        REQUIRE(p_go.at(column, row) == Approx(p).margin(2e-3));
        if (std::min(std::abs(p - 0.8), std::abs(p - 0.5)) > 3e-3)
          REQUIRE(verdict.at(column, row) == int(p >= 0.8   ? Verdict::go
                                                 : p >= 0.5 ? Verdict::slow_go
                                                            : Verdict::no_go));
      }
      if (verdict.at(column, row) == int(Verdict::no_go)) REQUIRE(reason.at(column, row) == int(Reason::slid_back));
      ++compared;
    }
  CHECK(compared > 1000);
  CHECK(summary.area.total() == std::uint64_t((kRows - 2) * (kColumns - 2) - 9));
  CHECK(summary.area.cells(Verdict::unknown, Reason::input_missing) == std::uint64_t(15 * (kColumns - 2)));
}

TEST_CASE("nothing outside what was sampled is ever go") {
  const TemporaryFolder folder;
  MapRequest request = small_request(folder);
  request.model.sampled[contract().variable_index("friction_angle")] = {29, 45};  // the soil has 28
  const MapSummary summary = make_map(request);
  // Weaker than sampled: no-go where the weakest sampled soil is, else unknown.
  CHECK(summary.area.cells(Verdict::unknown) + summary.area.cells(Verdict::no_go) == summary.area.total());
  CHECK(summary.area.cells(Verdict::unknown) > 1000);
  REQUIRE(summary.remarks.size() == 5);
  CHECK(contains(summary.remarks[1], "the friction angle does not say its test and counts as triaxial compression"));
  CHECK(contains(summary.remarks[0], "friction_angle 28 deg is outside 29 to 45 deg"));
  CHECK(contains(summary.remarks[3], "friction_angle lies outside what trials sampled, 29 to 45 deg, on "));
}

TEST_CASE("a map has the same bytes for any number of threads and any tile size") {
  const TemporaryFolder folder;
  MapRequest request = small_request(folder, "one");
  request.threads = 1;
  make_map(request);
  request.out = folder / "two";
  request.threads = 2;
  make_map(request);
  request.out = folder / "seven";
  request.threads = 7;
  make_map(request);
  for (const char* name :
       {"go.tif", "p_go.tif", "reason.tif", "outside_share.tif", "go_worst.tif", "p_go_best.tif", "p_go_low.tif",
        "area.csv", "map.png", "index.html", "map.json", "classes.gpkg", "overlay.png", "stac.json"}) {
    INFO(name);
    CHECK(read_file(folder / "two" / name) == read_file(folder / "one" / name));
    CHECK(read_file(folder / "seven" / name) == read_file(folder / "one" / name));
  }
  for (const int rows : {7, 1}) test::check_strips(request, rows);
}

TEST_CASE("a finished map is kept, and made again when an input or a file of it changes") {
  const TemporaryFolder folder;
  MapRequest request = small_request(folder);
  const MapSummary first = make_map(request);
  CHECK_FALSE(first.reused);
  const MapSummary second = make_map(request);
  CHECK(second.reused);
  CHECK(second.files == first.files);
  CHECK(second.area.csv(100) == first.area.csv(100));
  request.rules.go = 0.9;
  CHECK_FALSE(make_map(request).reused);
  write_file_atomically(folder / "map/area.csv", "edited");
  CHECK_FALSE(make_map(request).reused);
  CHECK(contains(read_file(folder / "map/area.csv"), "slow_go,all"));
  request.model.hash = "another";
  CHECK_FALSE(make_map(request).reused);
}

TEST_CASE("an unusable raster leaves no map behind") {
  const TemporaryFolder folder;
  const MapRequest request = small_request(folder);
  test::make_raster(folder / "dem.tif", {.value = std::vector<float>(48, -9999.0f)});
  CHECK(contains(input_error([&] { make_map(request); }), "every cell is nodata"));
  CHECK_FALSE(std::filesystem::exists(folder / "map"));
}

TEST_CASE("the figure of the sample region shows its classes in their colours") {
  const TemporaryFolder folder;
  const MapRequest request = sagehen_request(folder / "map");
  const MapSummary summary = make_map(request);
  CHECK(summary.area.total() == 743u * 688u);
  CHECK(summary.area_km2 == Approx(743 * 688 * 1e-4));
  CHECK(summary.area.share(Verdict::go) > 0.3);
  CHECK(summary.area.cells(Verdict::no_go) > 0);
  GDALAllRegister();
  GDALDataset* png = GDALDataset::Open((folder / "map/map.png").c_str());
  REQUIRE(png);
  CHECK(png->GetRasterXSize() == 2400);
  const int width = png->GetRasterXSize(), height = png->GetRasterYSize();
  std::vector<unsigned char> red(std::size_t(width) * height), green(red.size());
  REQUIRE(png->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, width, height, red.data(), width, height, GDT_Byte, 0, 0,
                                          nullptr) == CE_None);
  REQUIRE(png->GetRasterBand(2)->RasterIO(GF_Read, 0, 0, width, height, green.data(), width, height, GDT_Byte, 0, 0,
                                          nullptr) == CE_None);
  GDALClose(png);
  // The main panel is where the map is: strongly green where go, and go is at least the share that it should be.
  std::size_t greenish = 0, white = 0;
  for (std::size_t i = 0; i < red.size(); ++i) {
    greenish += green[i] > red[i] + 60;
    white += red[i] == 255 && green[i] == 255;
  }
  CHECK(double(greenish) > 0.5 * summary.area.share(Verdict::go) * 1200 * 1100);
  CHECK(double(white) / double(red.size()) > 0.2);
  CHECK(double(white) / double(red.size()) < 0.7);
}

TEST_CASE("P(go) of the sample region equals the model at 1,000 random cells") {
  const TemporaryFolder folder;
  const MapRequest request = sagehen_request(folder / "map");
  make_map(request);
  const RasterSource dem = RasterSource::open_elevation(request.region.elevation.files);
  const terrain::MapGrid& grid = dem.grid();
  const Tile slope = terrain::slope_degrees(dem.read({-1, -1, grid.columns + 2, grid.rows + 2}), {10, 10});
  const Tile soil = layer(request.region.soil_class->files.file.front(), request.region.elevation.files.file.front());
  const Tile p_go = layer(folder / "map/p_go.tif", request.region.elevation.files.file.front());
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::size_t cell = random_bits(5, 0, std::uint64_t(i)) % slope.value.size();
    if (std::isnan(p_go.value[cell])) continue;
    const auto found = std::find_if(request.region.soils.begin(), request.region.soils.end(),
                                    [&](const Soil& s) { return float(s.code) == soil.value[cell]; });
    REQUIRE(found != request.region.soils.end());
    double mean = 0;
    for (const SoilSample& sample : found->samples)
      mean += kSagehenModel.p_go(rounded_slope(slope.value[cell]), sample.values.at("friction_angle").low,
                                 sample.values.at("cohesion").low) /
              double(found->samples.size());
    REQUIRE(p_go.value[cell] == Approx(mean).margin(1e-6));
    ++compared;
  }
  CHECK(compared > 800);
}
