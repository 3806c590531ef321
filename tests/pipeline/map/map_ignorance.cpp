// What is not known never helps: a soil that fails is no better than unknown once its name, its moisture or its
// strength is taken away, and the weakest soil fails wherever all do.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/units.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/soil/soil.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using terrain::RasterKind;
using terrain::RasterSource;

namespace {

const ConeIndexNeed kHmmwv{"HMMWV", 16.6 * kPsi, 39.0 * kPsi};

/// Trials of the angles and cohesions of 32 mm grains, up to 35 degrees uphill.
OutcomeModel narrow_model() {
  OutcomeModel model = test::AnalyticModel{.width_deg = 2}.outcome_model();
  model.sampled[contract().variable_index("friction_angle")] = {14, 45};
  model.sampled[contract().variable_index("cohesion")] = {0, 15};
  model.sampled[contract().variable_index("slope_along")] = {-35, 35};
  model.sampled[contract().variable_index("slope_across")] = {-8, 8};
  model.cone_index = kHmmwv;
  return model;
}

SoilResponse response_of(const OutcomeModel& model, const Soil& soil) {
  const auto points = soil_points({}, soil, {}, 16);
  return SoilResponse(model, {}, points, 0, soft_points({}, soil, points, model.cone_index),
                      point_alternatives(soil, points.size()));
}

bool is_no_go(const CellClass& c) { return c.verdict == Verdict::no_go; }
bool is_no_go_or_unknown(const CellClass& c) { return is_no_go(c) || c.verdict == Verdict::unknown; }

/// Walls of 0, 5, ... 45 degrees, each ten columns wide.
constexpr int kColumns = 100, kRows = 6;
void make_walls(const std::filesystem::path& file) {
  std::vector<float> height(std::size_t(kColumns * kRows));
  double z = 500;
  for (int column = 0; column < kColumns; ++column) {
    z += 10 * std::tan(to_radians(5 * (column / 10)));
    for (int row = 0; row < kRows; ++row) height[std::size_t(row * kColumns + column)] = float(z);
  }
  test::make_raster(file, {.columns = kColumns, .rows = kRows, .value = height});
}

/// Classes of one row of a map of the walls on this soil.
std::vector<int> classes_on(const TemporaryFolder& folder, const Soil& soil, HeadingMode mode) {
  MapRequest request;
  request.model = narrow_model();
  request.region.file = folder / "walls.tif";
  request.region.name = "walls";
  request.region.elevation.files = terrain::RasterFiles(folder / "walls.tif");
  request.region.soils = {soil};
  request.rules.heading_mode = mode;
  request.out = folder / ("map_" + std::to_string(std::hash<std::string>{}(soil.name)) + std::to_string(int(mode)));
  make_map(request);
  const RasterSource go = RasterSource::open_elevation(request.out / "go.tif");
  const terrain::Tile tile = go.read({0, 0, kColumns, kRows});
  std::vector<int> row;
  for (int column = 0; column < kColumns; ++column) row.push_back(int(tile.at(column, 3)));
  return row;
}

}  // namespace

TEST_CASE("wet clay is no-go where the weakest sampled soil fails, on a wall steeper than sampled too") {
  const SoilResponse wet = response_of(narrow_model(), named_soil("clay", "wet"));
  REQUIRE(wet.points().sampled_count() == 0);
  CHECK(wet.at(5).result.verdict == Verdict::unknown);
  CHECK(wet.at(5).result.reason == Reason::soft_soil);
  CHECK(wet.at(5).p_high == Approx(1).margin(0.05));
  for (const double slope : {34.0, 40.0, 60.0}) {
    CAPTURE(slope);
    CHECK(is_no_go(wet.at(slope).result));
    CHECK(wet.at(slope).result.reason == Reason::slid_back);
    CHECK(wet.at(slope).p_high < 0.2);
    CHECK(std::isnan(wet.at(slope).p_go));
  }
  // The strength that was sampled bounds it: a stronger vehicle makes the same wall unknown.
  OutcomeModel strong = narrow_model();
  strong.probabilities = test::AnalyticModel{.width_deg = 2, .weaker_deg = -40}.outcome_model().probabilities;
  CHECK(response_of(strong, named_soil("clay", "wet")).at(34).result.verdict == Verdict::unknown);
}

TEST_CASE(
    "a soil that fails is no-go or unknown once its moisture or its name is not given, at any slope and heading") {
  const OutcomeModel model = narrow_model();
  const SoilResponse any = response_of(model, soil_not_given(""));
  std::map<std::string, SoilResponse> of_moisture;
  for (const char* moisture : {"dry", "moist", "wet"})
    of_moisture.emplace(moisture, response_of(model, soil_not_given(moisture)));
  for (const std::string& texture : terrain::usda_textures()) {
    const SoilResponse open = response_of(model, named_soil(texture, ""));
    for (const char* moisture : {"dry", "moist", "wet"}) {
      CAPTURE(texture, moisture);
      const SoilResponse one = response_of(model, named_soil(texture, moisture));
      const SoilResponse& of_this = of_moisture.at(moisture);
      int fails = 0;
      for (double slope = 0; slope <= 50; slope += 0.25)
        for (const double psi : {0.0, 0.2}) {
          if (is_no_go(any.at(slope, psi).result)) fails += !is_no_go(one.at(slope, psi).result);
          if (!is_no_go(one.at(slope, psi).result)) continue;
          for (const SoilResponse* less : {&open, &of_this, &any})
            fails += !is_no_go_or_unknown(less->at(slope, psi).result);
        }
      CHECK(fails == 0);
    }
  }
}

TEST_CASE("of two alternatives that differ, the map says unknown, and what both are where they agree") {
  const OutcomeModel model = narrow_model();
  Soil soil{.code = 0, .name = "one of two", .note = "", .texture = "sand", .samples = {}, .values = {}};
  for (const double angle : {20.0, 40.0}) {
    SoilSample sample;
    sample.values["friction_angle"] = {Spread::Kind::fixed, angle, angle, "test"};
    sample.values["cohesion"] = {Spread::Kind::fixed, 0, 0, "test"};
    sample.alternative = int(soil.samples.size());
    soil.samples.push_back(sample);
  }
  const SoilResponse two = response_of(model, soil);
  CHECK(two.at(5).result.verdict == Verdict::go);
  CHECK(two.at(19).result.verdict == Verdict::slow_go);  // 0.62 on the weak one
  CHECK(two.at(25).result.verdict == Verdict::unknown);  // none, or all
  CHECK(two.at(25).result.reason == Reason::input_missing);
  CHECK(two.at(25).p_go == Approx(0.5).margin(0.05));
  // Samples that were measured side by side are not alternatives: the map gives their mean.
  for (SoilSample& sample : soil.samples) sample.alternative = 0;
  CHECK(response_of(model, soil).at(24).result.verdict == Verdict::slow_go);
}

TEST_CASE("on a raster with walls of 0 to 45 degrees nothing that is not known makes a cell better") {
  const TemporaryFolder folder;
  make_walls(folder / "walls.tif");
  for (const HeadingMode mode : {HeadingMode::uphill, HeadingMode::worst}) {
    const std::vector<int> any = classes_on(folder, soil_not_given(""), mode),
                           open = classes_on(folder, named_soil("clay", ""), mode),
                           worst = classes_on(folder, named_soil("clay", "wet"), mode);
    int no_go = 0;
    for (int column = 1; column + 1 < kColumns; ++column) {
      CAPTURE(column, any[std::size_t(column)], open[std::size_t(column)], worst[std::size_t(column)]);
      const std::size_t c = std::size_t(column);
      if (any[c] == int(Verdict::no_go)) CHECK(worst[c] == int(Verdict::no_go));
      if (worst[c] != int(Verdict::no_go)) continue;
      ++no_go;
      CHECK((any[c] == int(Verdict::no_go) || any[c] == int(Verdict::unknown)));
      CHECK((open[c] == int(Verdict::no_go) || open[c] == int(Verdict::unknown)));
    }
    CHECK(no_go > 30);
    CHECK(worst[85] == int(Verdict::no_go));  // 40 degrees
  }
}
