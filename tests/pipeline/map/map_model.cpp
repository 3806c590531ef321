// The way from files to a map: a model file with known weights, a region and a study; what the map says is what the
// predictor says about the same inputs.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/math/random.h"
#include "base/units.h"
#include "learning/model/model.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/map_request.h"
#include "pipeline/outcome/answer/predictor.h"
#include "terrain/raster/layer/slope.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;
using namespace gonogo::map;
using learning::Encoder;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;

namespace {

const std::string kRegion = GONOGO_SOURCE_DIR "/configs/regions/sagehen.json";

struct Held {
  double low, high;
};

/// Sampled box of a study that holds the contract's fixed variables.
Held sampled_range(const std::string& name) {
  if (name == "slope_along") return {0, 35};
  if (name == "slope_across") return {-10, 10};
  if (name == "friction_angle") return {18, 40};
  if (name == "cohesion") return {0, 10};
  if (name == "relative_density") return {0.2, 0.9};
  if (name == "payload") return {0, 1000};
  if (name == "tyre_friction") return {0.3, 1};
  if (name == "bed_depth") return {0.3, 0.3};
  if (name == "commanded_speed") return {1.5, 1.5};
  return {0, 0};  // no obstacle
}

/// A machine whose first hidden unit carries steep slopes to slid_back and gentle ones to go, with noise everywhere, so
/// that every variable matters.
learning::Model made_model() {
  const Contract& c = contract();
  std::vector<Encoder> encoders;
  std::vector<std::string> outcomes;
  learning::Model model;
  for (const Variable& v : c.variables) {
    const Held held = sampled_range(v.name);
    const bool fixed = held.low == held.high;
    const int bins = fixed ? 1 : Encoder::bins_for_units(learning::Code::thermometer, v.encoder.bits);
    encoders.push_back(Encoder::by_range(v.name, v.unit, learning::Code::thermometer, bins, held.low, held.high));
    model.sampled_lower.push_back(held.low);
    model.sampled_upper.push_back(held.high);
  }
  for (const Outcome& outcome : c.outcomes) outcomes.push_back(outcome.name);
  model.layout = learning::VisibleLayout(std::move(encoders), std::move(outcomes));
  constexpr std::size_t hidden = 12;
  const std::size_t visible = model.layout.unit_count(), inputs = model.layout.input_unit_count();
  model.weights = learning::RbmWeights::zeros(visible, hidden);
  for (std::size_t i = 0; i < visible * hidden; ++i) model.weights.weight[i] = 0.8 * (random_unit(11, 1, i) - 0.5);
  const auto& slope = model.layout.encoders()[c.variable_index("slope_along")];
  for (std::size_t u = 0; u < slope.unit_count(); ++u)
    model.weights.weight[(model.layout.offset(c.variable_index("slope_along")) + u) * hidden] = 1.5;
  model.weights.hidden_bias[0] = -8;
  model.weights.weight[(inputs + c.outcome_index(Verdict::go, Reason::none)) * hidden] = -4;
  model.weights.weight[(inputs + c.outcome_index(Verdict::no_go, Reason::slid_back)) * hidden] = 4;
  model.weights.visible_bias[inputs + c.outcome_index(Verdict::go, Reason::none)] = 4;
  for (const Variable& v : c.variables)
    model.training_points.push_back((sampled_range(v.name).low + sampled_range(v.name).high) / 2);
  model.training_outcomes.push_back(0);
  model.training_weights.push_back(1);
  return model;
}

Tile on_grid(const std::filesystem::path& file, const terrain::MapGrid& grid) {
  return RasterSource::open_on_grid(file, grid, RasterKind::classes).read({0, 0, grid.columns, grid.rows});
}

}  // namespace

TEST_CASE("P(go) of the map is what the predictor says about the cell's inputs, at 1,000 random cells") {
  const TemporaryFolder folder;
  learning::write_model(folder / "model.h5", made_model());
  MapRequest request =
      read_map_request({.model = folder / "model.h5", .region = kRegion, .study = {}, .out = folder / "map"});
  request.model.cone_index = ConeIndexNeed{"a vehicle that every soil carries", 0, 0};
  const MapSummary summary = make_map(request);
  CHECK(summary.area.cells(Verdict::go) > 0);
  CHECK(summary.area.cells(Verdict::no_go) > 0);

  const Predictor predictor = Predictor::read(folder / "model.h5");
  const RasterSource dem = RasterSource::open_elevation(request.region.elevation.files);
  const terrain::MapGrid& grid = dem.grid();
  const Tile slope = terrain::slope_degrees(dem.read({-1, -1, grid.columns + 2, grid.rows + 2}), {10, 10});
  const Tile soil = on_grid(request.region.soil_class->files.file.front(), grid),
             p_go = on_grid(folder / "map/p_go.tif", grid);
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::size_t cell = random_bits(5, 0, std::uint64_t(i)) % slope.value.size();
    if (std::isnan(p_go.value[cell])) continue;
    const auto found = std::find_if(request.region.soils.begin(), request.region.soils.end(),
                                    [&](const Soil& s) { return float(s.code) == soil.value[cell]; });
    REQUIRE(found != request.region.soils.end());
    double mean = 0;
    for (const SoilSample& sample : found->samples) {
      std::vector<double> point(contract().variables.size(), std::nan(""));
      point[contract().variable_index("slope_along")] = rounded_slope(slope.value[cell]);
      point[contract().variable_index("slope_across")] = 0;
      point[contract().variable_index("friction_angle")] = sample.values.at("friction_angle").low;
      point[contract().variable_index("cohesion")] = sample.values.at("cohesion").low;
      mean += predictor.p_go(point) / double(found->samples.size());
    }
    REQUIRE(p_go.value[cell] == Approx(mean).margin(1e-6));
    ++compared;
  }
  CHECK(compared > 800);
}

TEST_CASE("the study's thresholds, mission and region reach the map request") {
  const TemporaryFolder folder;
  learning::write_model(folder / "model.h5", made_model());
  write_file_atomically(folder / "truck.json", R"({"vehicle": "truck"})");
  write_file_atomically(folder / "study.json", R"({"study": "s", "seed": 1, "vehicle": "truck.json", "region": ")" +
                                                   kRegion +
                                                   R"(", "map": {"go": 0.9, "fidelity": "coarse demo fidelity",
      "values": {"payload": {"fixed": 500, "source": "mission"}}}})");
  const MapRequest request = read_map_request(
      {.model = folder / "model.h5", .region = {}, .study = folder / "study.json", .out = folder / "map"});
  CHECK(request.rules.go == 0.9);
  CHECK(request.rules.fidelity == "coarse demo fidelity");
  CHECK(request.rules.values.at("payload").low == 500);
  CHECK(request.model.vehicle == "truck");
  CHECK(request.region.name == read_region(kRegion).name);
  CHECK(request.model.sampled[contract().variable_index("cohesion")].maximum == 10);
}

TEST_CASE("the vehicle whose cone index counts is the study's or the one asked for; a rig of one wheel has none") {
  const TemporaryFolder folder;
  learning::write_model(folder / "model.h5", made_model());
  const std::string configs = GONOGO_SOURCE_DIR "/configs/";
  const auto request = [&](const std::string& study, const std::string& vehicle) {
    return read_map_request({.model = folder / "model.h5",
                             .region = kRegion,
                             .study = study.empty() ? "" : configs + study,
                             .whole_vehicle = vehicle.empty() ? "" : configs + vehicle,
                             .out = folder / "map"});
  };
  CHECK_FALSE(request("", "").model.cone_index);
  const auto demo = request("studies/demo.json", "").model.cone_index;
  REQUIRE(demo);
  CHECK(demo->one_pass / kPsi == Approx(16.6).margin(0.05));  // published for this mass
  CHECK(demo->fifty_passes / kPsi == Approx(39.0).margin(0.1));
  CHECK(request("studies/demo.json", "vehicles/m113.json").model.cone_index->vehicle != demo->vehicle);
  CHECK(contains(input_error([&] { request("", "vehicles/hmmwv_quarter.json"); }), "hmmwv_quarter.json"));
}

TEST_CASE("a map without a region or with an unusable model is refused in one sentence") {
  const TemporaryFolder folder;
  learning::write_model(folder / "model.h5", made_model());
  const auto refusal = [&](MapFiles files) { return input_error([&] { read_map_request(files); }); };
  CHECK(
      contains(refusal({.model = folder / "model.h5", .region = {}, .study = {}, .out = folder / "map"}), "--region"));
  CHECK(contains(refusal({.model = folder / "absent.h5", .region = kRegion, .study = {}, .out = folder / "map"}),
                 "absent.h5"));
  write_file_atomically(folder / "text.h5", "not a model");
  CHECK(contains(refusal({.model = folder / "text.h5", .region = kRegion, .study = {}, .out = folder / "map"}),
                 "text.h5"));
}
