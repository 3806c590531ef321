// From trials of ditches to a map: two small models trained on made trials of one vehicle, one of them of ditches. The
// map's cells say what both models answer to `gonogo infer` at the same inputs, and models that do not fit are refused.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/error.h"
#include "base/files/file.h"
#include "base/math/random.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/training/train_model.h"
#include "terrain/raster/layer/slope.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/made_shapes.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
namespace fs = std::filesystem;
using test::kSide;

namespace {

const fs::path kConfigs = fs::path(GONOGO_SOURCE_DIR) / "configs";

std::size_t index(const char* name) { return contract().variable_index(name); }

/// What the trials of a made dataset drove.
struct Drove {
  std::string vehicle = "ditch jumper", table = "calibration_32mm.json", keys = "\"compliant_tyres\": true";
  double gravity = kGravity;
  bool ditches = true;
};

Provenance provenance_of(const Drove& drove) {
  std::string vehicle = read_file(kConfigs / "vehicles/hmmwv.json");
  const std::string name = "\"vehicle\": \"hmmwv\"";
  vehicle.replace(vehicle.find(name), name.size(), "\"vehicle\": \"" + drove.vehicle + "\"");
  std::string study = R"({"study": "made", "seed": 1, "trial": {)" + drove.keys + "}";
  if (drove.gravity != kGravity) study += ", \"gravity\": " + std::to_string(drove.gravity);
  return {.study = study + "}",
          .contract_hash = "",
          .program_version = "",
          .backend = "cpu",
          .inputs = {},
          .libraries = {},
          .files = {{"vehicle", vehicle}, {"calibration", read_file(kConfigs / "soils" / drove.table)}}};
}

/// Outcomes drawn from a P(go) that falls with slope and, in ditches, with their section.
std::vector<TrialRecord> made_trials(bool ditches, std::uint64_t seed) {
  std::vector<TrialRecord> records;
  for (std::uint64_t i = 0; i < 160; ++i) {
    TrialRecord record;
    std::vector<double>& x = record.point.variables;
    x.assign(contract().variables.size(), 0);
    const auto draw = [&](const char* name, double low, double high) {
      x[index(name)] = low + (high - low) * random_unit(seed, i, index(name));
    };
    draw("slope_along", ditches ? -10 : -20, ditches ? 10 : 30);
    draw("slope_across", -10, 10);
    draw("friction_angle", 20, 40);
    draw("cohesion", 0, 5);
    x[index("relative_density")] = 0.5;
    x[index("tyre_friction")] = 0.8;
    x[index("bed_depth")] = ditches ? 0.9 : 0.25;
    x[index("commanded_speed")] = 2;
    if (ditches) draw("ditch_width", 0.5, 2);
    if (ditches) draw("ditch_depth", 0.1, 0.5);
    const double load = ditches ? 5 * x[index("ditch_width")] * x[index("ditch_depth")] : 0;
    const double p = 1 / (1 + std::exp(load + 0.3 * x[index("slope_along")] - 0.12 * x[index("friction_angle")]));
    record.point.index = record.point.seed = i;
    const bool go = random_unit(seed, i, 100) < p;
    record.verdict = go ? Verdict::go : Verdict::no_go;
    record.reason = go ? Reason::none : Reason::traction;
    record.measures.assign(contract().measures.size(), 1);
    records.push_back(record);
  }
  return records;
}

/// Writes dataset.h5 and model.h5 into data/<name> of the folder.
fs::path train(const TemporaryFolder& folder, const std::string& name, const Drove& drove) {
  const fs::path place = folder.path() / "data" / name;
  fs::create_directories(place);
  write_dataset(place / "dataset.h5", {made_trials(drove.ditches, 7), provenance_of(drove)});
  static const Config quick = Config::parse(R"({"hidden": 4, "epochs": 40, "folds": 2})", "learning");
  outcome::train_model(
      {.dataset = place / "dataset.h5", .model = place / "model.h5", .seed = 3, .learning = quick, .design = {}});
  return place / "model.h5";
}

void write_region(const TemporaryFolder& folder) {
  test::make_flat_ground(folder);
  test::write_shapes(folder, "ditches.geojson",
                     test::column_line(3.5, R"("w": 1.2, "d": 0.3)") + "," +
                         test::column_line(6.5, R"("w": 1.5, "d": 0.45)") + "," +
                         test::column_line(9.5, R"("w": 2.4, "d": 0.3)"));
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "ditches",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "s", "licence": "l"}],
    "values": {"friction_angle": {"fixed": 30, "source": "s"}, "cohesion": {"fixed": 2, "source": "s"},
               "relative_density": {"fixed": 0.5, "source": "s"}, "bed_depth": {"fixed": 0.25, "source": "s"},
               "tyre_friction": {"fixed": 0.8, "source": "s"}, "payload": {"fixed": 0, "source": "s"},
               "commanded_speed": {"fixed": 2, "source": "s"}},
    "texture": "sand",
    "obstacles": [)" + test::obstacle_entry("ditch", "ditches.geojson", R"(, "width_m": "w", "depth_m": "d")") +
                                                    "]}");
}

struct Layers {
  MapSummary summary;
  terrain::Tile go, p, slope;
};

Layers map_of(const TemporaryFolder& folder, const std::string& model, const std::string& crossing,
              const std::string& out) {
  MapFiles files;
  files.model = model;
  files.region = folder / "region.json";
  files.crossing_model = crossing;
  files.out = folder / out;
  const MapSummary summary = make_map(read_map_request(files));
  const auto read = [&](const char* name) {
    return terrain::RasterSource::open_as_it_lies(files.out / name).read({0, 0, kSide, kSide});
  };
  const auto dem = terrain::RasterSource::open_elevation(folder / "dem.tif");
  return {summary, read("go.tif"), read("p_go.tif"),
          terrain::slope_degrees(dem.read({-1, -1, kSide + 2, kSide + 2}), {10, 10})};
}

/// What `gonogo infer` says.
double inferred(const outcome::Predictor& predictor, double slope, double bed, double width, double depth) {
  outcome::Question question{std::vector<double>(contract().variables.size(), 0), std::nullopt, false};
  const auto set = [&](const char* name, double value) { question.variables[index(name)] = value; };
  set("slope_along", slope);
  set("friction_angle", 30);
  set("cohesion", 2);
  set("relative_density", 0.5);
  set("tyre_friction", 0.8);
  set("bed_depth", bed);
  set("commanded_speed", 2);
  set("ditch_width", width);
  set("ditch_depth", depth);
  return outcome::answer_question(predictor, question).p_go;
}

}  // namespace

TEST_CASE("cells of ditches hold the least of what both trained models infer, by option and by name") {
  const TemporaryFolder folder;
  write_region(folder);
  const fs::path soil = train(folder, "jumper", {.ditches = false}), ditch = train(folder, "jumper_ditch", {});
  const outcome::Predictor on_soil = outcome::Predictor::read(soil), in_ditch = outcome::Predictor::read(ditch);
  CHECK(crosses_ditches(in_ditch.model()));
  CHECK_FALSE(crosses_ditches(on_soil.model()));
  const Layers none = map_of(folder, soil, "", "none"), map = map_of(folder, soil, ditch.string(), "map");
  ::setenv("GONOGO_SHARE", folder.path().c_str(), 1);
  CHECK(find_model("ditch jumper") == folder.path() / "data/jumper/model.h5");
  const Layers named = map_of(folder, "ditch jumper", "", "named");
  ::unsetenv("GONOGO_SHARE");
  bool lower = false;
  for (int row = 1; row < kSide - 1; ++row)
    for (int column = 1; column < kSide - 1; ++column) {
      INFO(column << " " << row);
      const double slope = rounded_slope(map.slope.at(column, row));
      const double ground = inferred(on_soil, slope, 0.25, 0, 0);
      const float p = map.p.at(column, row);
      if (column == 9 || column == 3 || column == 6) CHECK(Verdict(int(none.go.at(column, row))) == Verdict::unknown);
      if (column == 9) {
        CHECK(Verdict(int(map.go.at(column, row))) == Verdict::unknown);
        continue;
      }
      double expected = ground;
      if (column == 3) expected = std::min(ground, inferred(in_ditch, slope, 0.9, 1.2, 0.3));
      if (column == 6) expected = std::min(ground, inferred(in_ditch, slope, 0.9, 1.5, 0.45));
      lower |= expected < ground - 0.05;
      CHECK(p == Approx(expected).margin(1e-6));
      CHECK(named.p.at(column, row) == p);
      if (column != 3 && column != 6) CHECK(none.p.at(column, row) == p);
    }
  CHECK(lower);
  const auto says = [](const MapSummary& summary, const char* text) {
    return std::any_of(summary.remarks.begin(), summary.remarks.end(),
                       [&](const std::string& remark) { return contains(remark, text); });
  };
  CHECK(says(map.summary, "ditches on 4.5 % of the area are unknown: their trials sampled widths of"));
  CHECK(says(map.summary, "trials of ditches decide on 9.1 % of the area"));
  CHECK_FALSE(says(none.summary, "ditches"));
}

TEST_CASE("models of ditches that do not fit the vehicle's model are refused, and none that ships is taken then") {
  const TemporaryFolder folder;
  write_region(folder);
  const fs::path soil = train(folder, "jumper", {.ditches = false});
  const auto refusal = [&](const Drove& drove) {
    const fs::path other = train(folder, "other_ditch", drove);
    return input_error([&] { map_of(folder, soil, other.string(), "refused"); });
  };
  CHECK(contains(refusal({.ditches = false}), "no trial of it crosses a ditch of varied width and depth"));
  CHECK(contains(refusal({.vehicle = "another truck"}), "is of the vehicle another truck, and the model"));
  CHECK(contains(refusal({.table = "calibration_90mm.json"}), "grains of 90 mm"));
  CHECK(contains(refusal({.keys = ""}), "rigid tyres"));
  CHECK(contains(refusal({.keys = R"("compliant_tyres": true, "wheel_rolling": 1)"}), "wheel_rolling 1"));
  CHECK(contains(refusal({.gravity = 1.62}), "its trials had a gravity of 1.62 m/s2"));
  CHECK_FALSE(fs::exists(folder / "refused"));
  ::setenv("GONOGO_SHARE", folder.path().c_str(), 1);
  const auto shipped = find_crossing_model(read_trained_model(soil), "");
  ::unsetenv("GONOGO_SHARE");
  CHECK_FALSE(shipped);
  const fs::path ditch = train(folder, "jumper_ditch", {});
  CHECK(contains(input_error([&] { map_of(folder, ditch, "", "refused"); }), "give the vehicle's other model"));
  CHECK(contains(input_error([&] { map_of(folder, soil, (folder / "gone.h5").string(), "refused"); }), "gone.h5"));
}
