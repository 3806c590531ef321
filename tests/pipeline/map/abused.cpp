// Inputs that people give by mistake. Each is refused in one sentence or handled and said; none is silently a map.
#include <cmath>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::map;
using test::make_raster;
using test::RasterRecipe;

namespace {

constexpr int kSide = 24;

/// Gentle hills around 500 m over cells of `cell` metres.
std::vector<float> hills(double cell = 10) {
  std::vector<float> value;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      value.push_back(float(500.37 + 0.6 * cell * std::sin(column / 4.0) * std::cos(row / 5.0)));
  return value;
}

RasterRecipe ground() { return {.columns = kSide, .rows = kSide, .value = hills()}; }

RasterRecipe ground_in(const std::string& crs, double west, double north, double cell, double metres) {
  RasterRecipe r = ground();
  r.crs = crs;
  r.transform = {west, cell, 0, north, 0, -cell};
  r.value = hills(metres);
  return r;
}

RasterRecipe codes_of(float west, float east) {
  RasterRecipe r = ground();
  for (int i = 0; i < kSide * kSide; ++i) r.value[std::size_t(i)] = i % kSide < kSide / 2 ? west : east;
  return r;
}

/// A region file of dem.tif, with more rasters and keys.
std::string region(const std::string& rasters = "", const std::string& keys = "", const std::string& elevation = "") {
  return R"({"schema": "gonogo/region/1", "region": "abused", "rasters": [
    {"role": "elevation", "file": "dem.tif", "source": "s", "licence": "l")" +
         elevation + "}" + rasters + "]" + keys + "}";
}

std::string raster(const std::string& role, const std::string& more = "") {
  return R"(, {"role": ")" + role + R"(", "file": "second.tif", "source": "s", "licence": "l")" + more + "}";
}

const std::string kSoils = R"(, "soils": [{"code": 1, "name": "sand", "like": "sand"}])";

/// What make_map() says: the sentence of its refusal, or its remarks, and the share of each verdict.
struct Answer {
  std::string refusal, remarks;
  double unknown = 0;
  MapSummary summary{};
};

Answer map_of(const TemporaryFolder& folder, double gravity = kGravity) {
  Answer answer;
  try {
    MapRequest request;
    request.model = test::AnalyticModel{}.outcome_model();
    request.model.gravity = gravity;
    request.region = read_region(folder / "region.json");
    request.out = folder / "map";
    answer.summary = make_map(request);
    for (const std::string& remark : answer.summary.remarks) answer.remarks += remark + "\n";
    answer.unknown = answer.summary.area.share(campaign::Verdict::unknown);
  } catch (const InputError& error) {
    answer.refusal = error.what();
    CHECK_FALSE(std::filesystem::exists(folder / "map/map.json"));
  }
  return answer;
}

/// Lays dem.tif and a region file into a folder, as `make` says, and maps them.
template <class Make>
Answer abused(Make make) {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", ground());
  write_file_atomically(folder / "region.json", region());
  make(folder);
  return map_of(folder);
}

Answer with_dem(const RasterRecipe& dem) {
  return abused([&](const TemporaryFolder& folder) { make_raster(folder / "dem.tif", dem); });
}

Answer with_region(const std::string& text) {
  return abused([&](const TemporaryFolder& folder) { write_file_atomically(folder / "region.json", text); });
}

Answer with_second(const RasterRecipe& second, const std::string& text) {
  return abused([&](const TemporaryFolder& folder) {
    make_raster(folder / "second.tif", second);
    write_file_atomically(folder / "region.json", text);
  });
}

/// One sentence that names a file and holds these words.
void check_refused(const Answer& answer, const std::string& words) {
  INFO("refusal: " << answer.refusal << "\nremarks: " << answer.remarks);
  CHECK(contains(answer.refusal, words));
  CHECK(answer.refusal.find('\n') == std::string::npos);
}

void check_said(const Answer& answer, const std::string& words) {
  INFO("refusal: " << answer.refusal << "\nremarks: " << answer.remarks);
  CHECK(contains(answer.remarks, words));
}

}  // namespace

TEST_CASE("files that are no elevation are refused with the file's name") {
  const auto file = [](const std::string& content) {
    return abused([&](const TemporaryFolder& folder) { write_file_atomically(folder / "dem.tif", content); });
  };
  check_refused(abused([](const TemporaryFolder& f) { std::filesystem::remove(f / "dem.tif"); }), "dem.tif");  // 1
  check_refused(file("hello"), "dem.tif");                                                                     // 2
  check_refused(file(""), "dem.tif");                                                                          // 3
  check_refused(abused([](const TemporaryFolder& f) {
                  std::filesystem::resize_file(f / "dem.tif", std::filesystem::file_size(f / "dem.tif") / 2);
                }),
                "dem.tif");  // 4
  check_refused(abused([](const TemporaryFolder& f) {
                  std::filesystem::remove(f / "dem.tif");
                  std::filesystem::create_directory(f / "dem.tif");
                }),
                "dem.tif");                                                            // 5
  check_refused(file(R"({"type": "FeatureCollection", "features": []})"), "dem.tif");  // 6
  check_refused(
      file("<VRTDataset rasterXSize=\"9\" rasterYSize=\"9\"><VRTRasterBand dataType=\"Float32\" band=\"1\">"
           "<SimpleSource><SourceFilename>gone.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>"),
      "dem.tif");  // 7
}

TEST_CASE("elevation rasters that lie nowhere, or where no map can lie, are refused") {
  RasterRecipe dem = ground();
  dem.epsg = 0;
  check_refused(with_dem(dem), "coordinate system");  // 8
  dem = ground();
  dem.with_transform = false;
  check_refused(with_dem(dem), "dem.tif");  // 9
  dem = ground();
  dem.transform = {500000, 10, 3, 4400000, 3, -10};
  check_refused(with_dem(dem), "rotated");  // 10
  dem.transform = {500000, 10, 0, 4400000, 0, 10};
  CHECK(with_dem(dem).refusal.empty());  // 11, the southern row first
  dem.transform = {500000, 0, 0, 4400000, 0, 0};
  check_refused(with_dem(dem), "dem.tif");                                       // 12
  check_refused(with_dem(ground_in("EPSG:4326", -180, 90, 15, 10)), "degrees");  // 13, the whole globe
  check_refused(with_dem(ground_in("EPSG:4326", 10, 97, 1e-4, 10)), "dem.tif");  // 14, beyond the pole
  check_said(with_dem(ground_in("EPSG:32610", -4e6, 4.4e6, 10, 10)), "warped from WGS 84 / UTM zone 10N");  // 15
  check_refused(with_dem(ground_in("EPSG:32610", 5e5, 4.4e6, 1e6, 10)), "dem.tif");  // 16, cells of 1,000 km
  dem = ground();
  dem.columns = 2;
  check_refused(with_dem(dem), "3 x 3");  // 17
  dem = ground();
  dem.rows = 1;
  check_refused(with_dem(dem), "3 x 3");  // 18
}

TEST_CASE("rasters whose values are no heights are refused, and voids are said") {
  RasterRecipe dem = ground();
  for (const float fill : {-9999.f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    dem.value.assign(std::size_t(kSide) * kSide, fill);
    check_refused(with_dem(dem), "dem.tif");  // 19, 20, 21
  }
  dem.value.assign(std::size_t(kSide) * kSide, 0.f);
  dem.transform = {500000, 100, 0, 4400000, 0, -100};
  const Answer flat = with_dem(dem);
  check_said(flat, "exactly one height");  // 22
  CHECK(flat.unknown == 1);
  dem = ground();
  for (float& v : dem.value) v += 40000;
  check_refused(with_dem(dem), "dem.tif");  // 23
  dem = ground();
  dem.value[40] = 29999;
  check_said(with_dem(dem), "29999");  // 24
  dem = ground();
  dem.unit = "furlong";
  check_refused(with_dem(dem), "furlong");  // 25
  dem = ground();
  dem.type = GDT_CFloat32;
  check_refused(with_dem(dem), "complex");  // 26
  dem = ground();
  dem.bands = 3;
  check_refused(with_dem(dem), "bands");  // 27
  dem = ground();
  dem.scale = 0;
  check_refused(with_dem(dem), "scale");                                                        // 28
  check_said(with_dem(ground_in("EPSG:32610", 5e5, 4.4e6, 900, 900)), "cells are 900 m wide");  // 29
  dem = ground();
  dem.type = GDT_Byte;
  dem.nodata.reset();
  for (float& v : dem.value) v -= 440;
  for (const int cell : {260, 261, 284, 285}) dem.value[std::size_t(cell)] = 255;
  check_said(with_dem(dem), "4 cells of the elevation hold 255");
}

TEST_CASE("region files that cannot be meant are refused with the key") {
  check_refused(with_region(region().substr(0, 60)), "region.json");                             // 30
  check_refused(with_region("[]"), "region.json");                                               // 31
  check_refused(with_region(region("", R"(, "grid": {"cell_m": 0})")), "cell_m");                // 32
  check_refused(with_region(region("", R"(, "grid": {"crs": "EPSG:999999"})")), "EPSG:999999");  // 33
  check_refused(with_region(region("", R"(, "values": {"friction_angle": {"range": [36, 28], "source": "s"}})")),
                "friction_angle");  // 34
  check_refused(with_region(region("", R"(, "values": {"friction_angle": {"fixed": 95, "source": "s"}})")),
                "friction_angle");  // 35
  check_refused(with_region(region("", R"(, "values": {"friction_angel": {"fixed": 30, "source": "s"}})")),
                "friction_angle");                                                                   // 36
  check_refused(with_region(region("", "", R"(, "error_m": -1, "error_source": "s")")), "error_m");  // 37
  check_refused(with_region(region("", R"(, "gravity": "lunar")")), "gravity");                      // 38
  check_refused(with_region(region("", R"(, "texture": "mud")")), "texture");                        // 39
  check_refused(with_region(region(R"(, {"role": "elevation", "file": "dem.tif", "source": "s", "licence": "l"})")),
                "role");  // 40
}

TEST_CASE("second rasters that do not belong are refused, and codes that mean nothing are unknown and said") {
  check_refused(with_second(codes_of(1, 1), region(raster("soil_class"))), "soils");       // 41
  check_refused(with_second(codes_of(1, 1), region(raster("land_cover"))), "land_cover");  // 42
  check_refused(with_second(codes_of(1, 1), region(raster("cone_index"))), "unit");        // 43
  check_refused(with_second(codes_of(1, 1), region(raster("moisture"))), "moisture");      // 44
  RasterRecipe second = codes_of(1, 1);
  second.epsg = 0;
  check_refused(with_second(second, region(raster("soil_class"), kSoils)), "coordinate system");  // 45
  second = codes_of(1, 1);
  second.transform[0] += 1e6;
  check_refused(with_second(second, region(raster("soil_class"), kSoils)), "second.tif");  // 46
  check_refused(
      with_second(codes_of(1, 1), region(raster("soil_class"), R"(, "soils": [{"code": 70000, "name": "s"}])")),
      "code");  // 47
  for (const float code : {1.5f, 77.f}) {
    const Answer half = with_second(codes_of(code, 1), region(raster("soil_class"), kSoils));
    check_said(half, "the soil is unknown on");  // 48, 49
    CHECK(half.unknown > 0.4);
  }
}

TEST_CASE("a raster of cone indices or moisture that states another unit than it is read in is refused") {
  const std::string in_psi = region(raster("cone_index", R"(, "unit": "psi")")),
                    in_kpa = region(raster("cone_index", R"(, "unit": "kPa")")),
                    moisture = region(
                        raster("moisture"),
                        R"(, "moisture": {"source": "assumed", "dry": [0, 8], "moist": [8, 20], "wet": [20, 500]})");
  const auto stated = [](const std::string& unit) {
    RasterRecipe second = codes_of(60, 60);
    second.unit = unit;
    return second;
  };
  check_refused(with_second(stated("kPa"), in_psi), "--calc=\"A*0.145038\"");
  check_refused(with_second(stated("MPa"), in_psi), "--calc=\"A*145.038\"");
  check_refused(with_second(stated("MPa"), in_kpa), "--calc=\"A*1000\"");
  check_refused(with_second(stated("degC"), in_kpa), "says that its values are in \"degC\"");
  check_refused(with_second(stated("fraction"), moisture), "--calc=\"A*100\"");
  check_refused(with_second(stated("m3 m-3"), moisture), "% of the dry mass");
  for (const char* unit : {"", "psi", "PSI", "lbf/in2"})
    CHECK_FALSE(contains(with_second(stated(unit), in_psi).refusal, "says that its values"));
  for (const char* unit : {"kPa", "kN/m2"})
    CHECK_FALSE(contains(with_second(stated(unit), in_kpa).refusal, "says that its values"));
}

TEST_CASE("maps of other worlds, the antimeridian, the poles and the edges of UTM open in GDAL") {
  struct Place {
    const char *name, *crs;
    double west, north, cell, metres, gravity;
  };
  const Place place =
      GENERATE(Place{"Mars", "+proj=eqc +lat_ts=20 +lat_0=0 +R=3396190 +units=m", 1e6, 1.19e6, 50, 50, 3.71},
               Place{"Moon in degrees", "+proj=longlat +R=1737400", 30, 10, 1e-3, 30, 1.62},
               Place{"Moon, south pole", "+proj=stere +lat_0=-90 +R=1737400 +units=m", -120, 120, 10, 10, 1.62},
               Place{"antimeridian in degrees", "EPSG:4326", 179.999, -16.5, 1e-4, 10, kGravity},
               Place{"antimeridian in UTM", "EPSG:32701", 179600, 8173000, 10, 10, kGravity},
               Place{"north pole", "EPSG:3413", -120, 120, 10, 10, kGravity},
               Place{"south pole", "EPSG:3031", -120, 120, 10, 10, kGravity},
               Place{"85 N in degrees", "EPSG:4326", 20, 85, 1e-3, 20, kGravity},
               Place{"UTM at 84 N", "EPSG:32633", 5e5, 9328000, 10, 10, kGravity},
               Place{"UTM at 80 S", "EPSG:32733", 5e5, 1118500, 10, 10, kGravity},
               Place{"UTM beside its zone", "EPSG:32633", 160000, 5e6, 10, 10, kGravity},
               Place{"equator across UTM north", "EPSG:32633", 5e5, 120, 10, 10, kGravity});
  INFO(place.name);
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", ground_in(place.crs, place.west, place.north, place.cell, place.metres));
  write_file_atomically(folder / "region.json", region());
  const Answer answer = map_of(folder, place.gravity);
  INFO(answer.refusal);
  REQUIRE(answer.refusal.empty());
  GDALAllRegister();
  for (const char* name : {"go.tif", "p_go.tif", "reason.tif"}) {
    GDALDataset* file = GDALDataset::Open((folder / "map" / name).c_str());
    REQUIRE(file);
    CHECK(file->GetSpatialRef());
    const int columns = file->GetRasterXSize(), rows = file->GetRasterYSize();
    std::vector<float> value(std::size_t(columns) * std::size_t(rows));
    CHECK(file->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, columns, rows, value.data(), columns, rows, GDT_Float32, 0, 0,
                                           nullptr) == CE_None);
    const double nodata = file->GetRasterBand(1)->GetNoDataValue();
    CHECK(std::count_if(value.begin(), value.end(), [&](float v) { return v != float(nodata); }) > 300);
    GDALClose(file);
  }
}
