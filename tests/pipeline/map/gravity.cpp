// Maps of other worlds: the gravity of ground and trials, and files that GDAL opens.
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/write/compare_maps.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::map;

namespace {

constexpr const char* kMoon = "+proj=stere +lat_0=-90 +R=1737400 +units=m";
constexpr const char* kMars = "+proj=eqc +lon_0=30 +R=3396190 +units=m";
constexpr double kVesta = 255000;  // radius [m]

struct Place {
  std::string crs;
  double west, north, cell;
};

/// Hills of 24 x 24 cells at a place; `keys` go into the region file.
void make_ground(const TemporaryFolder& folder, const Place& place, const std::string& keys = "") {
  constexpr int side = 24;
  std::vector<float> height;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      height.push_back(float(-2000 + 0.5 * place.cell * std::sin(column / 3.0) * std::cos(row / 4.0)));
  test::make_raster(folder / "dem.tif", {.columns = side,
                                         .rows = side,
                                         .transform = {place.west, place.cell, 0, place.north, 0, -place.cell},
                                         .value = height,
                                         .crs = place.crs});
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "place",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none"}])" +
                                                    keys + "}");
}

MapRequest request_at(const TemporaryFolder& folder, double gravity, const std::string& out) {
  MapRequest request = test::request_of_region(folder, out);
  request.model.gravity = gravity;
  return request;
}

std::string refusal(const TemporaryFolder& folder, double gravity) {
  return input_error([&] { make_map(request_at(folder, gravity, "refused")); });
}

/// Opens every raster of a map with GDAL and checks size and system against the elevation.
void check_rasters(const TemporaryFolder& folder, const std::string& out) {
  GDALAllRegister();
  for (const char* name : {"go.tif", "p_go.tif", "reason.tif", "p_go_low.tif", "go_worst.tif"}) {
    INFO(name);
    GDALDataset* file = GDALDataset::Open((folder / out / name).c_str());
    REQUIRE(file);
    CHECK(file->GetSpatialRef());
    double transform[6];
    CHECK(file->GetGeoTransform(transform) == CE_None);
    std::vector<float> value(std::size_t(file->GetRasterXSize()) * std::size_t(file->GetRasterYSize()));
    CHECK(file->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, file->GetRasterXSize(), file->GetRasterYSize(), value.data(),
                                           file->GetRasterXSize(), file->GetRasterYSize(), GDT_Float32, 0, 0,
                                           nullptr) == CE_None);
    GDALClose(file);
  }
}

}  // namespace

TEST_CASE("a lunar map takes trials of lunar gravity, keeps the Moon's system and says the gravity") {
  const TemporaryFolder folder;
  make_ground(folder, {kMoon, -20000, 15000, 20});
  const MapSummary summary = make_map(request_at(folder, 1.62, "map"));
  check_rasters(folder, "map");
  CHECK(summary.gravity == 1.62);
  CHECK(summary.area.share(campaign::Verdict::go) > 0.1);
  CHECK(Json::read(folder / "map/map.json").at("inputs").at("gravity_m_per_s2").number() == 1.62);
  CHECK(contains(read_file(folder / "map/map.json"), "trials and ground have a gravity of 1.62 m/s2"));
  CHECK(contains(terrain::RasterSource::open_as_it_lies(folder / "map/go.tif").grid().crs_wkt, "1737400"));
  CHECK(make_map(request_at(folder, 1.62, "map")).reused);
  make_map(request_at(folder, 1.63, "second"));
  const MapComparison result = compare_maps({folder / "map", folder / "second", folder / "compared"});
  CHECK(contains(compare_text(result), "gravity 1.62 m/s2"));
}

TEST_CASE("a map refuses trials of another gravity and names both") {
  const TemporaryFolder folder;
  make_ground(folder, {kMoon, -20000, 15000, 20});
  CHECK(contains(refusal(folder, kGravity),
                 "dem.tif: lies on the Moon with a gravity of 1.62 m/s2, and the trials of the model had 9.81 m/s2; "
                 "give a model of trials whose study says \"gravity\": 1.62"));
  make_ground(folder, {kMars, 0, 400000, 100});
  CHECK(contains(refusal(folder, 1.62), "lies on Mars with a gravity of 3.71 m/s2"));
  CHECK(make_map(request_at(folder, 3.73, "mars")).gravity == 3.73);  // within 2 %
  check_rasters(folder, "mars");
  make_ground(folder, {"EPSG:32610", 500000, 4400000, 10});
  CHECK(contains(refusal(folder, 1.62), "lies on the Earth with a gravity of 9.81 m/s2"));
  make_map(request_at(folder, kGravity, "earth"));
  CHECK_FALSE(contains(read_file(folder / "earth/map.json"), "gravity"));  // as maps of the Earth always were
}

TEST_CASE("a body that the program does not know has the gravity of the region file") {
  const TemporaryFolder folder;
  const std::string vesta = "+proj=stere +lat_0=-90 +R=" + std::to_string(kVesta) + " +units=m";
  make_ground(folder, {vesta, -2000, 1500, 20});
  CHECK(contains(refusal(folder, 0.25),
                 "region.json: gravity: is missing, and the elevation lies on a body with a "
                 "radius of 255 km"));
  make_ground(folder, {vesta, -2000, 1500, 20}, R"(, "gravity": 0.25)");
  CHECK(make_map(request_at(folder, 0.25, "map")).gravity == 0.25);
  make_ground(folder, {kMoon, -20000, 15000, 20}, R"(, "gravity": 9.81)");
  CHECK(
      contains(refusal(folder, kGravity), "gravity: is 9.81 m/s2, and the elevation lies on the Moon, which has 1.62"));
  make_ground(folder, {kMoon, -20000, 15000, 20}, R"(, "gravity": 99)");
  CHECK(contains(input_error([&] { read_region(folder / "region.json"); }), "gravity: value 99 is outside"));
}
