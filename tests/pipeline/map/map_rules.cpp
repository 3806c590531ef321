// Class rules, soil tables and their quadrature against closed form.
#include "pipeline/map/region/rules.h"

#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/region/region.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using test::AnalyticModel;

namespace {

Prospect prospect(double go, double slow, double traction, double slid_back, double outside = 0) {
  Prospect p{std::vector<double>(contract().outcomes.size(), 0.0), outside};
  p.outcome[contract().outcome_index(Verdict::go, Reason::none)] = go;
  p.outcome[contract().outcome_index(Verdict::slow_go, Reason::none)] = slow;
  p.outcome[contract().outcome_index(Verdict::no_go, Reason::traction)] = traction;
  p.outcome[contract().outcome_index(Verdict::no_go, Reason::slid_back)] = slid_back;
  return p;
}

Spread fixed(double x) { return {Spread::Kind::fixed, x, x, "test"}; }
Spread range(double low, double high) { return {Spread::Kind::range, low, high, "test"}; }

std::size_t index(const char* variable) { return contract().variable_index(variable); }

Soil loam(const std::vector<Spreads>& samples, Spreads values = {}) {
  Soil soil{.code = 4, .name = "loam", .note = "", .texture = "", .samples = {}, .values = std::move(values)};
  for (const Spreads& sample : samples) soil.samples.push_back({sample, "test"});
  return soil;
}

SoilResponse response(const AnalyticModel& model, const Soil& soil, const MapRules& rules = {}) {
  return SoilResponse(model.outcome_model(), rules, soil_points({}, soil, rules.values, rules.draws));
}

constexpr const char* kRegion = R"({"schema": "gonogo/region/1", "region": "r",
  "rasters": [{"role": "elevation", "file": "dem.tif", "source": "s", "licence": "l"},
              {"role": "soil_class", "file": "soil.tif", "source": "s", "licence": "l"}],
  "soils": [{"code": 4, "name": "loam", "samples": [{"friction_angle": 30, "cohesion": 2, "source": "s"}]}],
  "values": {"payload": {"range": [0, 400], "source": "s"}, "tyre_friction": {"unknown": "why"}}})";

/// The message for the region above with one piece of text replaced.
std::string refusal(const TemporaryFolder& folder, const std::string& old_text, const std::string& new_text) {
  std::string text = kRegion;
  const auto at = text.find(old_text);
  REQUIRE(at != std::string::npos);
  write_file_atomically(folder / "region.json", text.replace(at, old_text.size(), new_text));
  return input_error([&] { read_region(folder / "region.json"); });
}

}  // namespace

TEST_CASE("thresholds divide go, slow-go and no-go, ends included as documented") {
  const MapRules rules;
  CHECK(classify(prospect(0.8, 0, 0.2, 0), rules).verdict == Verdict::go);
  CHECK(classify(prospect(0.79, 0, 0.21, 0), rules).verdict == Verdict::slow_go);
  CHECK(classify(prospect(0.5, 0, 0.5, 0), rules).verdict == Verdict::slow_go);
  CHECK(classify(prospect(0.49, 0, 0.51, 0), rules).verdict == Verdict::no_go);
  // Passable, but slower than the go speed more often than not.
  CHECK(classify(prospect(0.3, 0.65, 0.05, 0), rules).verdict == Verdict::slow_go);
  CHECK(classify(prospect(0.3, 0.65, 0.05, 0), rules).reason == Reason::none);
}

TEST_CASE("a no-go cell gets its likeliest no-go reason, even when go is likelier than any of them") {
  CHECK(classify(prospect(0.45, 0, 0.3, 0.25), MapRules{}).reason == Reason::traction);
  CHECK(classify(prospect(0.45, 0, 0.25, 0.3), MapRules{}).reason == Reason::slid_back);
}

TEST_CASE("a cell is classed only if the part that was not sampled cannot change the class") {
  const MapRules rules;
  CHECK(classify(prospect(1, 0, 0, 0, 0.2), rules).verdict == Verdict::go);             // at least 0.8
  CHECK(classify(prospect(1, 0, 0, 0, 0.21), rules).verdict == Verdict::unknown);       // 0.79 to 1
  CHECK(classify(prospect(0, 0, 1, 0, 0.49), rules).verdict == Verdict::no_go);         // at most 0.49
  CHECK(classify(prospect(0, 0, 1, 0, 0.5), rules).verdict == Verdict::unknown);        // 0 to 0.5
  CHECK(classify(prospect(0.65, 0, 0.35, 0, 0.1), rules).verdict == Verdict::slow_go);  // 0.585 to 0.685
  CHECK(classify(prospect(1, 0, 0, 0, 1), rules).verdict == Verdict::unknown);
  CHECK(classify(prospect(1, 0, 0, 0, 1), rules).reason == Reason::outside_sampled);
  MapRules tolerant;
  tolerant.tolerated_outside_share = 0.3;
  CHECK(classify(prospect(1, 0, 0, 0, 0.3), tolerant).verdict == Verdict::go);
  CHECK(classify(prospect(1, 0, 0, 0, 0.31), tolerant).verdict == Verdict::unknown);
  tolerant.tolerated_outside_share = 1;
  CHECK(classify(prospect(1, 0, 0, 0, 1), tolerant).verdict == Verdict::unknown);
}

TEST_CASE("points of a soil are its samples, each with the same even points of the ranges") {
  const Soil soil =
      loam({{{"friction_angle", fixed(30)}}, {{"friction_angle", fixed(40)}}}, {{"cohesion", range(0, 8)}});
  const auto points = soil_points({}, soil, {{"payload", fixed(300)}}, 4);
  REQUIRE(points.size() == 8);
  CHECK(points[1][index("friction_angle")] == 30);
  CHECK(points[5][index("friction_angle")] == 40);
  std::vector<double> cohesion;
  for (int i = 0; i < 4; ++i) cohesion.push_back(points[std::size_t(i)][index("cohesion")]);
  CHECK(cohesion == std::vector<double>{1, 3, 5, 7});
  CHECK(points[3][index("payload")] == 300);
  CHECK(std::isnan(points[3][index("relative_density")]));
  CHECK(std::isnan(points[3][index("slope_along")]));
}

TEST_CASE("values of the study win over samples, samples over the soil, the soil over the region") {
  Region region;
  region.values = {
      {"friction_angle", fixed(11)}, {"cohesion", fixed(1)}, {"payload", fixed(100)}, {"relative_density", fixed(0.1)}};
  const Soil soil = loam({{{"friction_angle", fixed(33)}, {"payload", fixed(300)}}},
                         {{"friction_angle", fixed(22)}, {"cohesion", fixed(2)}});
  const auto point = soil_points(region, soil, {{"payload", fixed(400)}}, 1).at(0);
  CHECK(point[index("payload")] == 400);
  CHECK(point[index("friction_angle")] == 33);
  CHECK(point[index("cohesion")] == 2);
  CHECK(point[index("relative_density")] == 0.1);
}

TEST_CASE("P(go) of a soil is the mean over its samples, at the slope rounded to 1/64 degree") {
  const AnalyticModel model;
  const Soil soil = loam({{{"friction_angle", fixed(28)}, {"cohesion", fixed(1)}},
                          {{"friction_angle", fixed(22)}, {"cohesion", fixed(0)}}});
  const SoilResponse table = response(model, soil);
  for (const double slope : {0.0, 3.3, 17.009, 24.7, 34.999}) {
    const double rounded = std::round(slope * 64) / 64;
    CHECK(table.at(slope).p_go == float((model.p_go(rounded, 28, 1) + model.p_go(rounded, 22, 0)) / 2));
    CHECK(table.at(slope).outside_share == 0);
  }
}

TEST_CASE("a range is averaged like its integral") {
  const AnalyticModel model;
  MapRules rules;
  rules.draws = 64;
  const SoilResponse table = response(model, loam({}, {{"friction_angle", range(15, 35)}}), rules);
  // Mean of 1 / (1 + exp((s - f) / w)) over f in [a, b] is w / (b - a) log((e^(b/w) + e^(s/w)) / (e^(a/w) + e^(s/w))).
  const double w = model.width_deg, s = 24;
  const double mean = w / 20 * std::log((std::exp(35 / w) + std::exp(s / w)) / (std::exp(15 / w) + std::exp(s / w)));
  CHECK(table.at(s).p_go == Approx(mean).margin(2e-4));
}

TEST_CASE("soil values outside the sampled box count as not sampled and are named") {
  AnalyticModel model;
  OutcomeModel narrow = model.outcome_model();
  narrow.sampled[index("cohesion")] = {1, 5};
  const Soil soil = loam({{{"friction_angle", fixed(30)}, {"cohesion", fixed(2)}},
                          {{"friction_angle", fixed(30)}, {"cohesion", fixed(0.5)}}});
  const SoilResponse table(narrow, MapRules{}, soil_points({}, soil, {}, 1));
  CHECK(table.at(0).outside_share == 0.5);
  CHECK(table.at(0).p_go == float(model.p_go(0, 30, 2)));
  CHECK(table.at(0).result.verdict == Verdict::unknown);
  REQUIRE(table.outside_because().size() == 1);
  CHECK(table.outside_because()[0] == "cohesion 0.5 kPa is outside 1 to 5 kPa");
  CHECK(table.points().stronger_because().empty());
}

TEST_CASE("soil stronger than sampled counts as the strongest that was, and is named") {
  const AnalyticModel model;
  OutcomeModel narrow = model.outcome_model();
  narrow.sampled[index("cohesion")] = {0, 5};
  narrow.sampled[index("friction_angle")] = {15, 35};
  const Soil soil = loam({{{"friction_angle", fixed(30)}, {"cohesion", fixed(9)}},
                          {{"friction_angle", fixed(40)}, {"cohesion", fixed(2)}}});
  const SoilResponse table(narrow, MapRules{}, soil_points({}, soil, {}, 1));
  CHECK(table.at(20).outside_share == 0);
  CHECK(table.at(20).p_go == float((model.p_go(20, 30, 5) + model.p_go(20, 35, 2)) / 2));
  CHECK(table.outside_because().empty());
  CHECK(table.points().stronger_because() ==
        std::vector<std::string>{"friction_angle 40 deg counts as 35 deg, the most that was sampled",
                                 "cohesion 9 kPa counts as 5 kPa, the most that was sampled"});
}

TEST_CASE("steeper than sampled is no-go upslope of a sampled no-go, otherwise unknown, and never has a P(go)") {
  AnalyticModel model;
  const SoilResponse weak = response(model, loam({{{"friction_angle", fixed(20)}}}));
  CHECK(weak.at(35).result.verdict == Verdict::no_go);
  CHECK(weak.at(35.5).result.verdict == Verdict::no_go);
  CHECK(weak.at(35.5).result.reason == Reason::slid_back);
  CHECK(std::isnan(weak.at(35.5).p_go));
  CHECK(weak.at(35.5).outside_share == 1);
  const SoilResponse strong = response(model, loam({{{"friction_angle", fixed(45)}}}));
  CHECK(strong.at(35).result.verdict == Verdict::go);
  for (const double slope : {35.1, 40.0, 60.0, 89.0}) CHECK(strong.at(slope).result.verdict == Verdict::unknown);
}

TEST_CASE("gentler than sampled is unknown, and nothing is go when level cross-slope was not sampled") {
  AnalyticModel model;
  OutcomeModel steep_only = model.outcome_model();
  steep_only.sampled[index("slope_along")] = {5, 35};
  const auto points = soil_points({}, loam({{{"friction_angle", fixed(45)}}}), {}, 1);
  const SoilResponse table(steep_only, MapRules{}, points);
  CHECK(table.at(4.9).result.verdict == Verdict::unknown);
  CHECK(table.at(5).result.verdict == Verdict::go);
  OutcomeModel tilted = model.outcome_model();
  tilted.sampled[index("slope_across")] = {10, 20};
  const SoilResponse nothing(tilted, MapRules{}, points);
  for (const double slope : {0.0, 10.0, 30.0, 60.0}) CHECK(nothing.at(slope).result.verdict == Verdict::unknown);
}

TEST_CASE("the area table adds up and comes back from JSON") {
  AreaCount area;
  area.add(Verdict::go, Reason::none, 30);
  area.add(Verdict::no_go, Reason::traction, 50);
  area.add(Verdict::no_go, Reason::slid_back, 20);
  CHECK(area.share(Verdict::no_go) == Approx(0.7));
  CHECK(area.csv(100) ==
        "class,reason,cells,area_km2,share\n"
        "go,all,30,0.003000,0.300000\ngo,none,30,0.003000,0.300000\n"
        "slow_go,all,0,0.000000,0.000000\n"
        "no_go,all,70,0.007000,0.700000\nno_go,slid_back,20,0.002000,0.200000\nno_go,traction,50,0.005000,0.500000\n"
        "unknown,all,0,0.000000,0.000000\n");
  CHECK(AreaCount::from_json(area.to_json()).csv(100) == area.csv(100));
}

TEST_CASE("a region file is read, and refused with the place of the mistake") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "region.json", kRegion);
  const Region region = read_region(folder / "region.json");
  CHECK(region.elevation.files.file.front() == folder / "dem.tif");
  REQUIRE(region.soils.size() == 1);
  CHECK(region.soils[0].samples[0].values.at("cohesion").low == 2);
  CHECK(region.values.at("payload").high == 400);
  CHECK(region.values.at("tyre_friction").kind == Spread::Kind::unknown);

  CHECK(contains(refusal(folder, "\"role\": \"elevation\"", "\"role\": \"elevations\""), "rasters[0].role"));
  CHECK(contains(refusal(folder, "\"friction_angle\": 30", "\"friction_angle\": 130"), "between 10 and 50"));
  CHECK(contains(refusal(folder, "\"friction_angle\"", "\"friktion_angle\""), "friktion_angle"));
  CHECK(contains(refusal(folder, "\"cohesion\": 2, \"source\": \"s\"", "\"cohesion\": 2"), "samples[0].source"));
  CHECK(contains(refusal(folder, "[0, 400]", "[400, 0]"), "[low, high]"));
  CHECK(contains(refusal(folder, "\"payload\"", "\"payloads\""), "did you mean \"payload\""));
  CHECK(contains(refusal(folder, "\"payload\"", "\"slope_along\""), "come from the elevation raster"));
  CHECK(contains(refusal(folder, "\"soil_class\"", "\"elevation\""), "given twice"));
  CHECK(contains(refusal(folder, "gonogo/region/1", "gonogo/region/9"), "schema"));
}

TEST_CASE("the section map of a study is strict") {
  const auto rules_of = [](const std::string& text) {
    return input_error([&] { read_map_rules(Config::parse(text, "study.json")); });
  };
  CHECK(rules_of(R"({"go": 0.9, "no_go": 0.3, "values": {"payload": {"fixed": 300, "source": "mission"}}})").empty());
  CHECK(contains(rules_of(R"({"go": 1.5})"), "study.json: go"));
  CHECK(contains(rules_of(R"({"go": 0.6, "no_go": 0.7})"), "no_go"));
  CHECK(contains(rules_of(R"({"goo": 0.6})"), "go"));
}

TEST_CASE("the sample region's file holds, and every number in it has a source") {
  const Region region = read_region(GONOGO_SOURCE_DIR "/configs/regions/sagehen.json");
  CHECK(region.soils.size() == 5);
  for (const Soil& soil : region.soils) {
    CHECK_FALSE(soil.samples.empty());
    for (const SoilSample& sample : soil.samples) CHECK(contains(sample.source, "Wong"));
  }
}
