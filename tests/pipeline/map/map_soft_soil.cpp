// Fine-grained soil that is weaker than the vehicle needs: unknown or no-go with its reason in every layer, never go.
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/units.h"
#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/route/plan_route.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/soil/soil.h"
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

namespace {

constexpr int kSide = 24;
const ConeIndexNeed kHmmwv{"HMMWV", 16.6 * kPsi, 39.0 * kPsi};  // published for its mass
const std::vector<std::string> kClassLayers = {"go", "go_worst", "go_best"};

/// Prandtl's factor of cohesion, by the form of the textbooks, times Skempton's 9 / 5.14, and Reissner's of six inches
/// of soil of 1,500 kg/m3.
double textbook_index(double cohesion_kPa, double angle) {
  const double phi = to_radians(angle);
  const double nq = std::exp(kPi * std::tan(phi)) * (1 + std::sin(phi)) / (1 - std::sin(phi));
  return 1.7508 * (nq - 1) / std::tan(phi) * cohesion_kPa * 1e3 + nq * 1500 * kGravity * 0.1524;
}

/// Ground of 3 degrees; soil code 1 but for 2 in the southern quarter.
void make_ground(const TemporaryFolder& folder) {
  std::vector<float> height, soil;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      height.push_back(float(500 + 10 * column * std::tan(to_radians(3))));
      soil.push_back(row < 3 * kSide / 4 ? 1 : 2);
    }
  test::make_raster(folder / "dem.tif", {.columns = kSide, .rows = kSide, .value = height});
  test::make_raster(folder / "soil.tif", {.columns = kSide, .rows = kSide, .value = soil, .type = GDT_Byte});
}

std::string range(const terrain::SoilValue& value) {
  return R"({"range": [)" + std::to_string(value.low) + ", " + std::to_string(value.high) + R"(], "source": "table"})";
}

/// A state of configs/soils/usda.json as soil 1, sand as soil 2.
std::string usda_soils(const std::string& state) {
  for (const terrain::SoilState& s : terrain::read_soil(GONOGO_SOURCE_DIR "/configs/soils/usda.json").states)
    if (s.name == state)
      return R"([{"code": 1, "name": ")" + s.name + R"(", "texture": ")" + s.texture +
             R"(", "values": {"friction_angle": )" + range(s.friction_angle) + R"(, "cohesion": )" + range(s.cohesion) +
             R"(}}, {"code": 2, "name": "sand", "texture": "sand", "samples": [
               {"friction_angle": 32, "cohesion": 0, "source": "made"}]}])";
  FAIL("no state " << state);
  return "";
}

MapRequest request_of(const TemporaryFolder& folder, const std::string& soils, const std::string& rasters = "") {
  write_file_atomically(folder / "region.json",
                        R"({"schema": "gonogo/region/1", "region": "made", "rasters": [
      {"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none"},
      {"role": "soil_class", "file": "soil.tif", "source": "made", "licence": "none"})" +
                            rasters + R"(], "soils": )" + soils + "}");
  MapRequest request;
  request.model = test::AnalyticModel{}.outcome_model();
  request.model.sampled[contract().variable_index("slope_along")] = {-10, 35};
  request.model.sampled[contract().variable_index("slope_across")] = {-10, 10};
  request.model.cone_index = kHmmwv;
  request.region = read_region(folder / "region.json");
  request.out = folder / "map";
  return request;
}

Tile layer(const TemporaryFolder& folder, const std::string& name) {
  const auto grid = RasterSource::open_elevation(folder / "map/go.tif").grid();
  return RasterSource::open_on_grid(folder / ("map/" + name + ".tif"), grid, RasterKind::classes)
      .read({0, 0, kSide, kSide});
}

}  // namespace

TEST_CASE("wet clay loam of the USDA table is unknown for its softness in every heading; dry clay and sand are go") {
  const TemporaryFolder folder;
  make_ground(folder);
  for (const char* mode : {"uphill", "worst", "best", "45"}) {
    MapRequest request = request_of(folder, usda_soils("clay loam, wet"));
    set_heading(request.rules, mode, "test");
    const MapSummary summary = make_map(request);
    INFO(mode);
    for (const std::string& name : kClassLayers) {
      const Tile verdict = layer(folder, name);
      CHECK(verdict.at(5, 5) == int(Verdict::unknown));
      CHECK(verdict.at(5, kSide - 3) == int(Verdict::go));  // sand carries what it carries without a cone index
    }
    CHECK(layer(folder, "reason").at(5, 5) == int(Reason::soft_soil));
    CHECK(layer(folder, "p_go_low").at(5, 5) == 0);
    CHECK(summary.area.cells(Verdict::unknown, Reason::soft_soil) > 200);
    REQUIRE_FALSE(summary.remarks.empty());
    CHECK(contains(summary.remarks[0], "fine-grained (clay loam) with a cone index of"));
    CHECK(contains(summary.remarks[0], "HMMWV needs 39 psi (VCI50)"));
  }
  CHECK(contains(test::attribute_table(folder / "map/reason.tif"), "soft fine-grained soil"));
  const Json record = Json::read(folder / "map/map.json");
  CHECK(record.at("inputs").at("vehicle_cone_index").at("vci50_kPa").number() == Approx(39.0 * kPsi / 1e3));
  CHECK(contains(read_file(folder / "map/index.html"), "fine-grained (clay loam) with a cone index of"));
  CHECK(contains(read_file(folder / "map/area.csv"), "soft_soil"));
  make_map(request_of(folder, usda_soils("clay, dry")));
  CHECK(layer(folder, "go").at(5, 5) == int(Verdict::go));
  MapRequest light = request_of(folder, usda_soils("clay loam, wet"));
  light.model.cone_index = ConeIndexNeed{"someone on foot", 0, 0};
  make_map(light);
  CHECK(layer(folder, "go").at(5, 5) == int(Verdict::go));  // the cone index decided above, not the friction angle
}

TEST_CASE("the share of a fine-grained soil that is too soft is that of its points below VCI50") {
  const TemporaryFolder folder;
  make_ground(folder);
  for (const char* state : {"clay loam, wet", "loam, moist", "silt loam, wet", "silty clay, dry"}) {
    const MapRequest request = request_of(folder, usda_soils(state));
    const auto points = soil_points(request.region, request.region.soils[0], {}, 64);
    const SoftPoints soft = soft_points(request.region, request.region.soils[0], points, kHmmwv);
    double expected = 0;
    for (const auto& point : points)
      expected += textbook_index(point[contract().variable_index("cohesion")],
                                 point[contract().variable_index("friction_angle")]) < kHmmwv.fifty_passes;
    INFO(state);
    CHECK(std::count(soft.is_soft.begin(), soft.is_soft.end(), 1) == expected);
    CHECK(SoilPoints(request.model, points, soft).soft_share() == Approx(expected / double(points.size())));
    CHECK(soft.because.empty() == (expected == 0));
  }
}

TEST_CASE(
    "a class needs every soft point on its side: few soft points leave a safe go, no more of them are tolerated") {
  MapRules rules;
  std::vector<double> outcome(contract().outcomes.size(), 0.0);
  outcome[contract().outcome_index(Verdict::go, Reason::none)] = 1;
  CHECK(classify({outcome, 0.1, 0.1}, rules).verdict == Verdict::go);  // at least 0.9, whatever the soft tenth does
  CHECK(classify({outcome, 0.3, 0.3}, rules).verdict == Verdict::unknown);
  CHECK(classify({outcome, 0.3, 0.3}, rules).reason == Reason::soft_soil);
  CHECK(classify({outcome, 0.3, 0.1}, rules).reason == Reason::outside_sampled);
  rules.tolerated_outside_share = 0.5;
  CHECK(classify({outcome, 0.3, 0.0}, rules).verdict == Verdict::go);
  CHECK(classify({outcome, 0.3, 0.3}, rules).verdict == Verdict::unknown);
}

TEST_CASE("a soil counts as soft without a vehicle, without numbers, or without a texture below the angles of sand") {
  const TemporaryFolder folder;
  make_ground(folder);
  const auto soft_share = [&](const std::string& soil, const std::optional<ConeIndexNeed>& need) {
    const MapRequest request = request_of(folder, R"([{"code": 1, "name": "ground", )" + soil + "}]");
    const auto points = soil_points(request.region, request.region.soils[0], {}, 8);
    return SoilPoints(request.model, points, soft_points(request.region, request.region.soils[0], points, need))
        .soft_share();
  };
  const auto sample = [](double angle, double cohesion, const std::string& more = "") {
    return R"("samples": [{"friction_angle": )" + std::to_string(angle) + R"(, "cohesion": )" +
           std::to_string(cohesion) + more + R"(, "source": "made"}])";
  };
  const std::string clay = R"("texture": "clay", )", sand = R"("texture": "sand", )";
  CHECK(soft_share(clay + sample(20, 69), kHmmwv) == 0);
  CHECK(soft_share(clay + sample(20, 69), std::nullopt) == 1);
  CHECK(soft_share(sand + sample(32, 0), std::nullopt) == 0);
  CHECK(soft_share(sand + sample(12, 1), kHmmwv) == 0);
  CHECK(soft_share(sample(12, 1), kHmmwv) == 1);
  CHECK(soft_share(sample(32, 0), kHmmwv) == 0);
  CHECK(soft_share(clay + R"("samples": [{"friction_angle": 20, "source": "made"}])", kHmmwv) == 1);
  CHECK(soft_share(clay + sample(20, 69, R"(, "cone_index_kPa": 100)"), kHmmwv) == 1);
  CHECK(soft_share(clay + sample(12, 2, R"(, "cone_index_kPa": 900)"), kHmmwv) == 0);
}

TEST_CASE(
    "a raster of cone indices decides over fine-grained soil: no-go below VCI1, unknown below VCI50, else the model") {
  const TemporaryFolder folder;
  make_ground(folder);
  // Columns by quarters: 10, 30 and 60 psi and a hole; the same in kPa.
  for (const bool psi : {true, false}) {
    std::vector<float> index;
    for (int i = 0; i < kSide * kSide; ++i) {
      const float value = std::vector<float>{10, 30, 60, -9999}[std::size_t(i % kSide / (kSide / 4))];
      index.push_back(value < 0 || psi ? value : value * float(kPsi / 1e3));
    }
    test::make_raster(folder / "rci.tif", {.columns = kSide, .rows = kSide, .value = index});
    MapRequest request = request_of(folder, usda_soils("clay loam, wet"),
                                    R"(, {"role": "cone_index", "file": "rci.tif", "source": "made", "licence": "none",
        "unit": ")" + std::string(psi ? "psi" : "kPa") +
                                        R"("})");
    make_map(request);
    const Tile reason = layer(folder, "reason"), p = layer(folder, "p_go");
    const std::vector<std::pair<Verdict, Reason>> expected = {{Verdict::no_go, Reason::soft_soil},
                                                              {Verdict::unknown, Reason::soft_soil},
                                                              {Verdict::go, Reason::none},
                                                              {Verdict::unknown, Reason::soft_soil}};
    for (const std::string& name : kClassLayers) {
      const Tile verdict = layer(folder, name);
      for (int quarter = 0; quarter < 4; ++quarter) {
        const int column = quarter * kSide / 4 + 3;
        INFO(name << ", quarter " << quarter << (psi ? ", psi" : ", kPa"));
        CHECK(verdict.at(column, 5) == int(expected[std::size_t(quarter)].first));
        CHECK(reason.at(column, 5) == int(expected[std::size_t(quarter)].second));
        CHECK(verdict.at(column, kSide - 3) == int(Verdict::go));  // sand
      }
    }
    CHECK(std::isnan(p.at(3, 5)));
    CHECK(p.at(15, 5) > 0.95f);
    const MapSources sources = open_sources(request.region);
    const SoilTable table = make_soil_table(request.model, request.region, request.rules, 0);
    const RouteCells cells = read_route_cells(sources, request.region, table, request.rules, 1);
    CHECK(cells.soil[5 * kSide + 3] == RouteCells::kClosed);
    CHECK(table.soils[cells.soil[5 * kSide + 9]].name == "clay loam, wet, measured soft");
    CHECK(table.soils[cells.soil[5 * kSide + 15]].name == "clay loam, wet, measured firm");
    CHECK(table.soils[cells.soil[5 * kSide + 21]].name == "clay loam, wet");
  }
}

TEST_CASE("a cone index of all of the ground decides as a raster of it does") {
  const TemporaryFolder folder;
  make_ground(folder);
  const std::vector<std::pair<double, Verdict>> expected = {
      {10, Verdict::no_go}, {30, Verdict::unknown}, {60, Verdict::go}};
  for (const auto& [psi, verdict] : expected) {
    MapRequest request = request_of(folder, usda_soils("clay loam, wet"));
    request.region.cone_index_everywhere = psi * kPsi;
    const MapSummary summary = make_map(request);
    CHECK(layer(folder, "go").at(5, 5) == int(verdict));
    CHECK(layer(folder, "go").at(5, kSide - 3) == int(Verdict::go));  // sand
    CHECK(std::any_of(summary.remarks.begin(), summary.remarks.end(), [](const std::string& remark) {
      return contains(remark, "sand") && contains(remark, "the measured cone index is not used");
    }));
  }
}

TEST_CASE("a map names what it averages over, but not what its soils say themselves") {
  const TemporaryFolder folder;
  make_ground(folder);
  MapRequest request = request_of(folder, usda_soils("clay loam, wet"));
  for (const char* name : {"cohesion", "payload"})
    request.region.values[name] = {Spread::Kind::range, 1, 2, "not given", {}};
  std::string averaged;
  for (const std::string& remark : make_map(request).remarks)
    if (contains(remark, "P(go) is averaged over")) averaged += remark;
  CHECK(contains(averaged, "payload 1 to 2"));
  CHECK_FALSE(contains(averaged, "cohesion"));
}

TEST_CASE("a high cone index rules out the moistures that it contradicts") {
  const TemporaryFolder folder;
  make_ground(folder);
  MapRequest request = request_of(folder, usda_soils("clay loam, wet"));
  Soil clay = named_soil("CL", "");  // its wet state is always too soft
  clay.code = 1;
  request.region.soils[0] = clay;
  make_map(request);
  CHECK(layer(folder, "go").at(5, 5) == int(Verdict::unknown));
  request.region.cone_index_everywhere = 60 * kPsi;
  make_map(request);
  CHECK(layer(folder, "go").at(5, 5) == int(Verdict::go));
}

TEST_CASE("cone indices without a vehicle or a unit, and textures that nobody knows, are refused") {
  const TemporaryFolder folder;
  make_ground(folder);
  test::make_raster(folder / "rci.tif", {.columns = kSide, .rows = kSide});
  const std::string raster = R"(, {"role": "cone_index", "file": "rci.tif", "source": "made", "licence": "none")";
  MapRequest request = request_of(folder, usda_soils("clay loam, wet"), raster + R"(, "unit": "psi"})");
  request.model.cone_index.reset();
  CHECK(contains(input_error([&] { make_map(request); }), "name one by --vehicle"));
  CHECK(contains(input_error([&] { request_of(folder, usda_soils("clay loam, wet"), raster + "}"); }), "unit"));
  CHECK(contains(input_error([&] {
                   request_of(folder, R"([{"code": 1, "name": "x", "texture": "mud", "samples": [
        {"friction_angle": 20, "cohesion": 1, "source": "made"}]}])");
                 }),
                 "mud"));
}

TEST_CASE("every texture of the shipped soils is one of the triangle, and clays are fine-grained where sands are not") {
  for (const auto& state : terrain::read_soil(GONOGO_SOURCE_DIR "/configs/soils/usda.json").states) {
    const auto& names = terrain::usda_textures();
    CHECK(std::count(names.begin(), names.end(), state.texture) == 1);
    CHECK(terrain::is_fine_grained(state.texture) ==
          (!contains(state.texture, "sand") || state.texture == "sandy clay"));
  }
}
