// Land cover, moisture, tiles in degrees, members of a model, exports and comparisons of maps.

#include <cmath>
#include <map>

#include "base/error.h"
#include "base/files/file.h"
#include "base/units.h"
#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/write/compare_maps.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/raster/layer/layer_picture.h"
#include "tests/pipeline/map/analytic_model.h"
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

constexpr int kSide = 40;
constexpr float kWater = 11, kForest = 42, kGrass = 71, kNobodyKnows = 99;

/// A slope of about 15 degrees everywhere.
std::vector<float> slope_of_15() {
  std::vector<float> value;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      value.push_back(float(1000 + 10 * column * std::tan(to_radians(15))));
  return value;
}

/// Quarters of the ground by land cover, and by water content 5, 20, 60 and not known.
const std::string kRegion = R"({"schema": "gonogo/region/1", "region": "made <b>&\"ground\"</b>",
  "rasters": [{"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none"},
              {"role": "soil_class", "file": "soil.tif", "source": "made", "licence": "none"} MORE],
  "soils": [{"code": 4, "name": "loam", "samples": [
      {"friction_angle": 30, "cohesion": 0, "water_percent": 5, "source": "dry"},
      {"friction_angle": 14, "cohesion": 0, "water_percent": 40, "source": "wet"}]},
    {"code": 5, "name": "sand", "samples": [{"friction_angle": 30, "cohesion": 0, "water_percent": 2, "source": "dry"}]}] KEYS})";

void make_ground(const TemporaryFolder& folder) {
  test::make_raster(folder / "dem.tif", {.columns = kSide, .rows = kSide, .value = slope_of_15()});
  std::vector<float> soil, land, water;
  for (int i = 0; i < kSide * kSide; ++i) soil.push_back(i / kSide < 30 ? 4 : 5);
  for (int row = 0; row < kSide / 2; ++row)
    for (int column = 0; column < kSide / 2; ++column) {
      const bool west = column < kSide / 4, north = row < kSide / 4;
      land.push_back(north ? (west ? kWater : kForest) : west ? kGrass : kNobodyKnows);
    }
  for (int i = 0; i < kSide * kSide; ++i) water.push_back(i % kSide < 20 ? 5 : 60);
  test::make_raster(folder / "soil.tif", {.columns = kSide, .rows = kSide, .value = soil, .type = GDT_Byte});
  test::make_raster(folder / "land.tif", {.columns = kSide / 2,
                                          .rows = kSide / 2,
                                          .transform = {500000, 20, 0, 4400000, 0, -20},
                                          .nodata = 255,
                                          .value = land,
                                          .type = GDT_Byte});
  test::make_raster(folder / "water.tif", {.columns = kSide, .rows = kSide, .value = water});
}

MapRequest request_of(const TemporaryFolder& folder, const std::string& more, const std::string& keys,
                      const std::string& out) {
  std::string text = kRegion;
  text.replace(text.find("MORE"), 4, more);
  text.replace(text.find("KEYS"), 4, keys);
  write_file_atomically(folder / "region.json", text);
  MapRequest request;
  request.model = AnalyticModel{}.outcome_model();
  request.region = read_region(folder / "region.json");
  request.out = folder / out;
  return request;
}

const std::string kLandRaster = R"(, {"role": "land_cover", "file": "land.tif", "source": "made", "licence": "none"})";
const std::string kLandRules = R"(, "land_cover": [{"code": 11, "name": "water", "verdict": "no_go", "reason": "water"},
  {"code": 42, "name": "forest", "verdict": "unknown", "reason": "vegetation"},
  {"code": 71, "name": "grass", "verdict": "soil"}])";
const std::string kMoisture =
    R"(, "moisture": {"dry": [0, 15], "moist": [15, 30], "wet": [30, 100], "source": "test"})";

Tile layer(const std::filesystem::path& file) {
  const RasterSource source = RasterSource::open_on_grid(
      file, RasterSource::open_elevation(file.parent_path() / "go.tif").grid(), RasterKind::classes);
  return source.read({0, 0, source.grid().columns, source.grid().rows});
}

}  // namespace

TEST_CASE("land cover decides by its rules and its reasons, and what no rule names is unknown") {
  const TemporaryFolder folder;
  make_ground(folder);
  make_map(request_of(folder, kLandRaster, kLandRules, "map"));
  make_map(request_of(folder, "", "", "bare"));
  const Tile go = layer(folder / "map/go.tif"), reason = layer(folder / "map/reason.tif"),
             bare = layer(folder / "bare/go.tif"), p = layer(folder / "map/p_go.tif"),
             worst = layer(folder / "map/go_worst.tif");
  for (int row = 1; row < kSide - 1; ++row)
    for (int column = 1; column < kSide - 1; ++column) {
      INFO(column << " " << row);
      const bool west = column < 20, north = row < 20;
      const int verdict = int(go.at(column, row)), why = int(reason.at(column, row));
      if (north) {
        REQUIRE(verdict == int(west ? Verdict::no_go : Verdict::unknown));
        REQUIRE(why == int(west ? Reason::water : Reason::vegetation));
        REQUIRE(std::isnan(p.at(column, row)));
        REQUIRE(worst.at(column, row) == verdict);
      } else if (west) {
        REQUIRE(verdict == bare.at(column, row));
        REQUIRE_FALSE(std::isnan(p.at(column, row)));
      } else {
        REQUIRE(verdict == int(Verdict::unknown));
        REQUIRE(why == int(Reason::land_unknown));
      }
    }
}

TEST_CASE("a moisture scenario takes the samples of that water content, and a soil without any is unknown") {
  const TemporaryFolder folder;
  make_ground(folder);
  const auto p_of = [&](const std::string& moisture) {
    MapRequest request = request_of(folder, "", kMoisture, "map_" + moisture);
    request.rules.moisture = moisture;
    make_map(request);
    return layer(request.out / "p_go.tif");
  };
  const Tile dry = p_of("dry"), wet = p_of("wet"), any = p_of("");
  const AnalyticModel model;
  CHECK(dry.at(10, 10) == Approx(model.p_go(15, 30, 0)).margin(2e-3));
  CHECK(wet.at(10, 10) == Approx(model.p_go(15, 14, 0)).margin(2e-3));
  CHECK(any.at(10, 10) == Approx((model.p_go(15, 30, 0) + model.p_go(15, 14, 0)) / 2).margin(2e-3));
  CHECK(dry.at(10, 35) == Approx(model.p_go(15, 30, 0)).margin(2e-3));  // sand
  CHECK(std::isnan(wet.at(10, 35)));
  CHECK(layer(folder / "map_wet/reason.tif").at(10, 35) == int(Reason::input_missing));
  MapRequest unsaid = request_of(folder, "", "", "map");
  unsaid.rules.moisture = "wet";
  CHECK(contains(input_error([&] { make_map(unsaid); }), "does not say what \"wet\" is"));
}

TEST_CASE("a raster of water content chooses the state cell by cell") {
  const TemporaryFolder folder;
  make_ground(folder);
  make_map(request_of(folder, R"(, {"role": "moisture", "file": "water.tif", "source": "made", "licence": "none"})",
                      kMoisture, "map"));
  const Tile p = layer(folder / "map/p_go.tif");
  const AnalyticModel model;
  CHECK(p.at(10, 10) == Approx(model.p_go(15, 30, 0)).margin(2e-3));
  CHECK(p.at(30, 10) == Approx(model.p_go(15, 14, 0)).margin(2e-3));
}

TEST_CASE("regions whose keys do not fit together are refused") {
  const TemporaryFolder folder;
  make_ground(folder);
  const auto refusal = [&](const std::string& more, const std::string& keys) {
    return input_error([&] { request_of(folder, more, keys, "map"); });
  };
  CHECK(contains(refusal(kLandRaster, ""), "land_cover: missing"));
  CHECK(contains(refusal("", kLandRules), "no raster has the role \"land_cover\""));
  CHECK(contains(refusal(R"(, {"role": "moisture", "file": "water.tif", "source": "s", "licence": "l"})", ""),
                 "moisture: missing"));
  CHECK(contains(refusal("", R"(, "moisture": {"dry": [20, 10], "source": "s"})"), "[min, max]"));
}

TEST_CASE("the second region maps from tiles in degrees with a hole, by rules of its land cover") {
  const TemporaryFolder folder;
  MapRequest request;
  request.model = AnalyticModel{.weaker_deg = 8}.outcome_model();
  request.region = read_region(GONOGO_SOURCE_DIR "/configs/regions/zion.json");
  request.out = folder / "map";
  const MapSummary summary = make_map(request);
  const RasterSource go = RasterSource::open_elevation(folder / "map/go.tif");
  CHECK(go.grid().crs_name == "WGS 84 / UTM zone 12N");
  CHECK(summary.area.cells(Verdict::unknown, Reason::vegetation) > 10000);
  CHECK(summary.area.cells(Verdict::no_go, Reason::water) > 10);
  CHECK(summary.area.cells(Verdict::go) > 1000);
  bool says_how = false;
  for (const std::string& remark : summary.remarks) says_how = says_how || contains(remark, "warped from WGS 84");
  CHECK(says_how);
  const Tile cells = go.read({0, 0, go.grid().columns, go.grid().rows});
  CHECK(std::isnan(cells.at(go.grid().columns * 240 / 465, go.grid().rows * 230 / 457)));  // the missing tile
}

TEST_CASE("members of a model widen the interval on P(go) and change nothing else") {
  const OutcomeModel alone = AnalyticModel{}.outcome_model();
  OutcomeModel spread = alone;
  for (const double weaker : {-4.0, -2.0, 2.0, 4.0})
    spread.members.push_back(AnalyticModel{.weaker_deg = weaker}.outcome_model().probabilities);
  std::vector<double> point(contract().variables.size(), NAN);
  point[contract().variable_index("friction_angle")] = 20;
  const SoilResponse one(alone, MapRules{}, {point}), many(spread, MapRules{}, {point});
  for (const double slope : {10.0, 18.0, 20.0, 25.0}) {
    CHECK(many.at(slope).p_go == one.at(slope).p_go);
    CHECK(one.at(slope).p_low == one.at(slope).p_high);
    // Of five equally likely models the 5 % point is the least, the 95 % point the largest.
    CHECK(many.at(slope).p_low == Approx(AnalyticModel{.weaker_deg = 4}.p_go(slope, 20, NAN)).margin(1e-6));
    CHECK(many.at(slope).p_high == Approx(AnalyticModel{.weaker_deg = -4}.p_go(slope, 20, NAN)).margin(1e-6));
  }
}

TEST_CASE("the exports of a map open, hold its areas, and show hostile text as text") {
  const TemporaryFolder folder;
  make_ground(folder);
  const MapSummary summary = make_map(request_of(folder, kLandRaster, kLandRules, "map"));
  GDALAllRegister();
  GDALDataset* polygons = GDALDataset::Open((folder / "map/classes.gpkg").c_str(), GDAL_OF_VECTOR);
  REQUIRE(polygons);
  std::map<int, double> area;
  for (const auto& feature : polygons->GetLayerByName("classes"))
    area[feature->GetFieldAsInteger("code")] += feature->GetFieldAsDouble("area_km2");
  for (const Verdict v : {Verdict::go, Verdict::slow_go, Verdict::no_go, Verdict::unknown})
    CHECK(area[int(v)] == Approx(double(summary.area.cells(v)) * 1e-4).margin(1e-9));
  GDALClose(polygons);
  const std::string kml = read_file(folder / "map/overlay.kml");
  CHECK(contains(kml, "<name>made &lt;b&gt;&amp;&quot;ground&quot;&lt;/b&gt;</name>"));
  CHECK_FALSE(contains(kml, "<b>"));
  GDALDataset* picture = GDALDataset::Open((folder / "map/overlay.png").c_str());
  REQUIRE(picture);
  const GDALColorTable* colours = picture->GetRasterBand(1)->GetColorTable();
  REQUIRE(colours);
  CHECK(colours->GetColorEntry(int(Verdict::go))->c4 == 255);
  CHECK(colours->GetColorEntry(255)->c4 == 0);  // no data
  GDALClose(picture);
  const Json item = Json::read(folder / "map/stac.json");
  CHECK(item.at("type").string() == "Feature");
  CHECK(item.at("properties").at("proj:epsg").integer() == 32610);
  const auto& ring = item.at("geometry").at("coordinates").items()[0].items();
  CHECK(ring[3].items()[0].number() == Approx(-123).margin(1e-6));  // the central meridian is the western edge
  CHECK(item.at("bbox").items()[1].number() == Approx(ring[0].items()[1].number()).margin(1e-5));
  for (const auto& [name, asset] : item.at("assets").members())
    CHECK(std::filesystem::exists(folder / "map" / asset.at("href").string()));
}

namespace {

/// A map of waves of 30 m over cells of 100 m, anywhere on any body.
Json map_at(const TemporaryFolder& folder, const std::string& crs, double west, double north) {
  std::vector<float> height;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      height.push_back(float(1000 + 30 * std::sin(column / 3.0) * std::cos(row / 4.0)));
  test::make_raster(
      folder / "dem.tif",
      {.columns = kSide, .rows = kSide, .transform = {west, 100, 0, north, 0, -100}, .value = height, .crs = crs});
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "made",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none"}]})");
  MapRequest request;
  request.model = AnalyticModel{}.outcome_model();
  request.region = read_region(folder / "region.json");
  request.out = folder / "map";
  make_map(request);
  for (const char* file : {"go.tif", "index.html", "classes.gpkg", "map.json"})
    CHECK(std::filesystem::exists(folder / "map" / file));
  return Json::read(folder / "map/stac.json");
}

}  // namespace

TEST_CASE("a region on the antimeridian, at a pole or on a sphere without a way to WGS 84 has a whole map") {
  const TemporaryFolder folder;
  const Json across = map_at(folder, "EPSG:32701", 180000, 8118000);
  CHECK(across.at("geometry").at("type").string() == "MultiPolygon");
  CHECK(across.at("bbox").items()[0].number() > across.at("bbox").items()[2].number());
  CHECK(std::filesystem::exists(folder / "map/overlay_2.png"));
  const Json pole = map_at(folder, "EPSG:32761", 1998000, 2002000);
  CHECK(pole.at("bbox").items()[1].number() == Approx(-90));
  CHECK(std::filesystem::exists(folder / "map/overlay.png"));
  CHECK_FALSE(std::filesystem::exists(folder / "map/overlay_2.png"));  // the earlier map's
  // As large as the Earth, so that the gravity of the trials holds, but of no datum that PROJ relates to WGS 84.
  const Json sphere = map_at(folder, "+proj=laea +lat_0=-20 +lon_0=30 +R=6330000 +units=m", -2000, 2000);
  CHECK(sphere.at("properties").find("gonogo:degrees"));
  CHECK(sphere.at("bbox").items()[0].number() == Approx(30).margin(0.1));
  CHECK(contains(Json::read(folder / "map/map.json").at("remarks").dump(), "WGS 84"));
}

TEST_CASE("control characters have no place in XML and become spaces") {
  CHECK(terrain::xml_escaped("a\x01<b>\"&\n") == "a &lt;b&gt;&quot;&amp;\n");
}

TEST_CASE("the curve of speeds: least and harmonic mean of the best share of the area") {
  SpeedCurve curve;
  curve.add(SpeedCurve::step_of(2), 50);
  curve.add(SpeedCurve::step_of(1), 30);
  curve.add(0, 20);
  curve.add_unknown(100);
  const std::string text = curve.csv();
  CHECK(contains(text, "\n50,7.20,7.2000\n"));
  CHECK(contains(text, "\n80,3.60,5.2364\n"));  // 80 / (50/2 + 30/1)
  CHECK(contains(text, "\n81,0.00,0.0000\n"));
  CHECK(contains(text, "unknown,0.500000"));
}

TEST_CASE("two maps compared tell where one passes and whether P(go) differs by more than both leave open") {
  CHECK(significance(0.5, 0.4, 0.6, 0.5, 0.4, 0.6) == 0);
  CHECK(significance(0.2, 0.2, 0.2, 0.5, 0.5, 0.5) > 1e9);
  CHECK(significance(0.8, 0.7, 0.9, 0.3, 0.3, 0.3) == Approx(-0.5 / (0.2 / 3.29)));
  const TemporaryFolder folder;
  make_ground(folder);
  MapRequest first = request_of(folder, kLandRaster, kLandRules, "first");
  make_map(first);
  MapRequest second = request_of(folder, kLandRaster, kLandRules, "second");
  second.model = AnalyticModel{.weaker_deg = 12}.outcome_model();
  second.model.hash = "another";
  make_map(second);
  const MapComparison result = compare_maps({folder / "first", folder / "second", folder / "both"});
  const Tile a = layer(folder / "first/go.tif"), b = layer(folder / "second/go.tif");
  const auto on_grid = [&](const char* name) {
    const auto grid = RasterSource::open_elevation(folder / "first/go.tif").grid();
    return RasterSource::open_on_grid(folder / name, grid, RasterKind::classes).read({0, 0, kSide, kSide});
  };
  const Tile change = on_grid("both/change.tif"), difference = on_grid("both/difference.tif");
  const Tile pa = layer(folder / "first/p_go.tif"), pb = layer(folder / "second/p_go.tif");
  std::map<int, std::uint64_t> counted;
  for (std::size_t i = 0; i < change.value.size(); ++i) {
    REQUIRE(std::isnan(change.value[i]) == std::isnan(a.value[i]));
    if (std::isnan(a.value[i])) continue;
    const bool one = a.value[i] <= 2, two = b.value[i] <= 2, open = a.value[i] == 4 || b.value[i] == 4;
    const int expected = open ? 5 : one && two ? 1 : one ? 2 : two ? 3 : 4;
    REQUIRE(change.value[i] == expected);
    ++counted[expected];
    if (!std::isnan(pa.value[i])) REQUIRE(difference.value[i] == pb.value[i] - pa.value[i]);
  }
  CHECK(counted[2] > 100);
  GDALDataset* figure = GDALDataset::Open((folder / "both/compare.png").c_str());
  REQUIRE(figure);
  CHECK(figure->GetRasterXSize() == 2400);
  GDALClose(figure);
  for (const ComparedClass& row : result.change) CHECK(row.cells == counted[row.code]);
  CHECK(compare_json(result).at("change").items()[1].at("cells").unsigned_integer() == counted[2]);
  MapRequest worst = request_of(folder, "", "", "worst");
  worst.rules.heading_mode = HeadingMode::worst;
  make_map(worst);
  CHECK(contains(input_error([&] {
                   compare_maps({folder / "first", folder / "worst", folder / "x"});
                 }),
                 "uphill heading"));
  CHECK_THROWS_AS(compare_maps({folder / "first", folder / "nothing", folder / "x"}), InputError);
}
