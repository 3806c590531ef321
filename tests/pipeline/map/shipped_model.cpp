// The models that ship: found by name, refused for another vehicle, and asked for what is known beforehand.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/math/random.h"
#include "learning/model/posterior.h"
#include "learning/score/score.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/region/rules.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/predictor.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

const std::string kSource = GONOGO_SOURCE_DIR;
const std::string kDem = kSource + "/configs/regions/sagehen/elevation_10m.tif";

/// A row of data/hmmwv_32mm/known_outcomes.csv.
struct KnownOutcome {
  std::string row, expected;
  std::vector<double> variables;
};

std::vector<KnownOutcome> known_outcomes(const std::string& file) {
  std::ifstream in(file);
  std::string text;
  std::getline(in, text);
  std::vector<std::string> columns;
  std::stringstream header(text);
  for (std::string name; std::getline(header, name, ',');) columns.push_back(name);
  std::vector<KnownOutcome> rows;
  while (std::getline(in, text)) {
    KnownOutcome known{text, "", std::vector<double>(contract().variables.size(), NAN)};
    std::stringstream fields(text);
    for (const std::string& column : columns) {
      std::string field;
      std::getline(fields, field, ',');
      if (column == "expected") {
        known.expected = field;
        break;
      }
      known.variables[contract().variable_index(column)] = std::stod(field);
    }
    rows.push_back(known);
  }
  return rows;
}

MapFiles files_of(const TemporaryFolder& folder) {
  MapFiles files;
  files.model = "hmmwv";
  files.dem = kDem;
  files.out = folder / "map";
  return files;
}

}  // namespace

TEST_CASE("the shipped model of the HMMWV says what is known beforehand") {
  const TrainedModel model = read_trained_model(find_model("hmmwv"));
  const auto rows = known_outcomes(kSource + "/data/hmmwv_32mm/known_outcomes.csv");
  REQUIRE(rows.size() >= 12);
  for (const KnownOutcome& known : rows) {
    CHECK(model.predictor->inside_sampled_box(known.variables));
    const Prospect prospect{model.predictor->outcome_probabilities(known.variables), 0, 0};
    const Verdict verdict = classify(prospect, MapRules{}).verdict;
    INFO(known.row << " has P(go) " << prospect.p_go());
    if (known.expected == "go") CHECK(verdict == Verdict::go);
    if (known.expected == "passable") CHECK(passes(verdict));
    if (known.expected == "no_go") CHECK(verdict == Verdict::no_go);
    CHECK((known.expected == "go" || known.expected == "passable" || known.expected == "no_go"));
  }
}

TEST_CASE("the shipped model of the HMMWV forecasts trials of another seed, which it never saw") {
  const TrainedModel model = read_trained_model(find_model("hmmwv"));
  // The model answers at the numerics of the first. Contacts of the second are left unsolved.
  const std::string file = GENERATE("hmmwv_32mm_fresh/dataset.h5", "hmmwv_32mm_unsolved/fresh_rolling.h5");
  const Dataset fresh = read_dataset(kSource + "/data/" + file);
  REQUIRE(fresh.records.size() == 400);
  std::vector<double> p, sure;  // `sure`: outside 0.2 to 0.8
  std::vector<int> passed, sure_passed;
  for (const TrialRecord& trial : fresh.records) {
    REQUIRE(trial.verdict != Verdict::unknown);
    p.push_back(Prospect{model.predictor->outcome_probabilities(trial.point.variables), 0, 0}.p_go());
    passed.push_back(passes(trial.verdict));
    if (p.back() >= 0.2 && p.back() <= 0.8) continue;
    sure.push_back(p.back());
    sure_passed.push_back(passed.back());
  }
  const double brier = learning::brier_score(p, passed);
  const double calibration = learning::calibration_error(learning::reliability(p, passed, 10));
  const double accuracy = learning::accuracy(sure, sure_passed);
  std::printf("400 trials of %s: Brier score %.4f, calibration error %.4f, accuracy outside 0.2 to 0.8 %.4f on %zu\n",
              file.c_str(), brier, calibration, accuracy, sure.size());
  CHECK(brier <= 0.045);
  CHECK(calibration <= 0.03);
  CHECK(accuracy >= 0.97);
}

TEST_CASE("models that ship are found by name and by vehicle; their trials lie beside them") {
  const std::filesystem::path file = find_model("hmmwv_32mm");
  CHECK(find_model("hmmwv") == file);
  CHECK(find_model(kSource + "/data/hmmwv_32mm").filename() == "model.h5");
  const TrainedModel model = read_trained_model(file);
  REQUIRE(model.vehicle);
  INFO("model.h5 is older than dataset.h5: train it again (data/hmmwv_32mm/README.md)");
  CHECK(model.is_up_to_date);
  CHECK(model.vehicle->name == "hmmwv");
  CHECK(!vehicle::is_quarter(model.vehicle->vehicle));
  CHECK(model.vehicle->fidelity() == "whole vehicle on grains of 32 mm, 7.9 across a wheel");
  const std::string refused = input_error([] { find_model("hmvw"); });
  CHECK(contains(refused, "did you mean \"hmmwv\"?"));
  CHECK(contains(refused, "hmmwv_32mm"));
}

TEST_CASE("models of a rover and an eight-wheeler ship with their trials, and climbing makes passing less likely") {
  const std::string vehicle = GENERATE("mgru3_rover", "argo_8x8");
  const std::filesystem::path file = find_model(vehicle);
  CHECK(file == find_model(vehicle + "_32mm"));
  const TrainedModel model = read_trained_model(file);
  INFO("model.h5 is older than dataset.h5: train it again (data/" << vehicle << "_32mm/README.md)");
  CHECK(model.is_up_to_date);
  REQUIRE(model.vehicle);
  CHECK(model.vehicle->name == vehicle);
  CHECK(!vehicle::is_quarter(model.vehicle->vehicle));
  const Dataset trials = read_dataset(kSource + "/data/" + vehicle + "_32mm/dataset.h5");
  CHECK(trials.records.size() >= 600);
  const auto p_go = [&](double slope) {
    std::vector<double> point(contract().variables.size(), NAN);
    point[contract().variable_index("slope_along")] = slope;
    return Prospect{model.predictor->outcome_probabilities(point), 0, 0}.p_go();
  };
  CHECK(p_go(0) > 0.95);
  CHECK(p_go(0) > p_go(20));
  CHECK(p_go(20) > p_go(33));
  CHECK(p_go(33) < 0.6);
}

TEST_CASE(
    "a map of an elevation raster takes the soil by name, and the mission's open values from trials and vehicle") {
  const TemporaryFolder folder;
  MapFiles files = files_of(folder);
  files.soil = "Sandy loam";
  files.moisture = "wet";
  files.set = {"payload=500"};
  const MapRequest request = read_map_request(files);
  CHECK(request.model.vehicle == "hmmwv");
  CHECK(request.model.whole_vehicle);
  CHECK(request.model.cone_index->vehicle == "hmmwv");
  CHECK(request.model.speed);
  CHECK(request.rules.values.at("payload").low == 500);
  REQUIRE(request.region.soils.size() == 1);
  const Soil& soil = request.region.soils.front();
  CHECK(soil.name == "sandy loam, wet");
  REQUIRE(soil.samples.size() == 1);
  CHECK(soil.samples[0].values.at("friction_angle").low == 11);
  CHECK(soil.samples[0].values.at("friction_angle").high == 33.7);
  const auto points = soil_points(request.region, soil, request.rules.values, request.rules.draws);
  CHECK(points.size() == 32);
  double lightest = 1, heaviest = 0;
  for (const auto& point : points) {
    CHECK(point[contract().variable_index("payload")] == 500);
    const double friction = point[contract().variable_index("tyre_friction")];
    lightest = std::min(lightest, friction);
    heaviest = std::max(heaviest, friction);
  }
  CHECK(lightest >= 0.8);  // 0.9 of the vehicle's file, +- 0.1
  CHECK(lightest < 0.82);
  CHECK(heaviest > 0.98);
}

TEST_CASE("a soil file that has the name of a texture is told from the texture wherever it is named") {
  const TemporaryFolder folder;
  MapFiles files = files_of(folder);
  files.soil = "sandy_loam";
  const MapRequest measured = read_map_request(files);
  CHECK(measured.region.soils.front().name == "sandy loam of sandy_loam.json");
  CHECK(measured.region.soils.front().not_texture == "sandy_loam.json");
  CHECK(contains(conditions_text(measured), "sandy_loam.json"));
  files.soil = "sandy loam";
  const MapRequest texture = read_map_request(files);
  CHECK(texture.region.soils.front().name == "sandy loam");
  CHECK(texture.region.soils.front().not_texture.empty());
}

TEST_CASE("a map of an elevation raster takes a raster of textures by the names of its classes") {
  const TemporaryFolder folder;
  MapFiles files = files_of(folder);
  files.soil = kSource + "/configs/regions/sagehen/usda_texture_30m.tif";
  const Region region = read_map_request(files).region;
  REQUIRE(region.soils.size() == 12);
  CHECK(region.soils[3].code == 4);
  CHECK(region.soils[3].name == "loam");
  CHECK(region.soils[3].samples.size() == 3);  // dry, moist, wet
}

TEST_CASE("without a soil most of a map is unknown, says so, and is nowhere go for want of knowledge") {
  const TemporaryFolder folder;
  const MapSummary summary = make_map(read_map_request(files_of(folder)));
  CHECK(summary.area.share(Verdict::unknown) > 0.5);
  CHECK(summary.area.share(Verdict::go) == 0);
  CHECK(summary.area.cells(Verdict::unknown, Reason::input_missing) >
        0.9 * double(summary.area.cells(Verdict::unknown)));
  REQUIRE_FALSE(summary.remarks.empty());
  CHECK(std::any_of(summary.remarks.begin(), summary.remarks.end(),
                    [](const std::string& remark) { return contains(remark, "no soil was given"); }));
  CHECK(std::any_of(summary.remarks.begin(), summary.remarks.end(), [](const std::string& remark) {
    return contains(remark, "friction_angle lies outside what trials sampled, 15") && contains(remark, "% of the area");
  }));
  const std::string page = read_file(folder / "map/index.html");
  CHECK(contains(page, "\"title\":\"hmmwv\""));
  CHECK_FALSE(contains(page, "quarter vehicle"));
}

TEST_CASE("what a shipped model is not made for is refused in one sentence") {
  const TemporaryFolder folder;
  const auto refusal = [&](auto change) {
    MapFiles files = files_of(folder);
    change(files);
    return input_error([&] { read_map_request(files); });
  };
  CHECK(contains(refusal([](MapFiles& f) { f.vehicle = kSource + "/configs/vehicles/m113.json"; }),
                 "the vehicle m113 is asked for"));
  CHECK(contains(refusal([](MapFiles& f) { f.study = kSource + "/configs/studies/quarter_wheel_32mm.json"; }),
                 "hmmwv_quarter"));
  CHECK(contains(refusal([](MapFiles& f) { f.soil = "sandy laom"; }), "did you mean \"sandy loam\"?"));
  CHECK(contains(refusal([](MapFiles& f) { f.set = {"slope_along=5"}; }), "elevation raster"));
  CHECK(contains(refusal([](MapFiles& f) { f.region = kSource + "/configs/regions/sagehen.json"; }), "--region"));
  MapFiles beside = files_of(folder);
  beside.study = kSource + "/configs/studies/demo.json";  // of a quarter, but it learns the model's trials
  CHECK_NOTHROW(read_map_request(beside));
  MapFiles files = files_of(folder);
  files.vehicle = kSource + "/configs/vehicles/hmmwv.json";
  CHECK_NOTHROW(read_map_request(files));
  Json lighter = Json::read(files.vehicle);
  lighter["chassis"]["mass_kg"] = 1000.0;
  write_file_atomically(folder / "lighter.json", lighter.dump());
  CHECK(contains(refusal([&](MapFiles& f) { f.vehicle = folder / "lighter.json"; }), "\"chassis\" differs"));
}

TEST_CASE("slopes of shipped models are answered within the stated error of the sum at each slope") {
  const std::size_t along = contract().variable_index("slope_along"),
                    across = contract().variable_index("slope_across");
  const std::size_t outcomes = contract().outcomes.size();
  for (const char* name : {"hmmwv_32mm", "viper_32mm", "quarter_wheel_90mm"}) {
    const auto predictor = outcome::Predictor::read(kSource + "/data/" + name + "/model.h5");
    const learning::Model& model = predictor.model();
    const auto steps = [&](std::size_t v) {
      std::vector<double> slopes;
      for (double s = std::ceil(model.sampled_lower[v]); s <= model.sampled_upper[v]; s += 0.5) slopes.push_back(s);
      return slopes;
    };
    const std::vector<double> alongs = steps(along), acrosses = steps(across);
    double most = 0;
    for (std::uint64_t soil = 0; soil < 3; ++soil) {
      std::vector<double> point(contract().variables.size(), NAN);
      for (const char* variable : {"friction_angle", "cohesion"}) {
        const std::size_t v = contract().variable_index(variable);
        point[v] = model.sampled_lower[v] + random_unit(5, v, soil) * (model.sampled_upper[v] - model.sampled_lower[v]);
      }
      std::vector<double> answers(alongs.size() * acrosses.size() * outcomes);
      predictor.on_slopes(point, alongs, acrosses, answers);
      for (std::uint64_t k = 0; k < 200; ++k) {
        const auto i = std::size_t(random_unit(6, soil, k) * double(alongs.size())),
                   j = std::size_t(random_unit(7, soil, k) * double(acrosses.size()));
        point[along] = alongs[i];
        point[across] = acrosses[j];
        const std::vector<double> expected = predictor.outcome_probabilities(point);
        for (std::size_t y = 0; y < outcomes; ++y)
          most = std::max(most, std::abs(answers[(i * acrosses.size() + j) * outcomes + y] - expected[y]));
      }
    }
    std::printf("%s: largest difference %.1e\n", name, most);
    CHECK(most < learning::kGridError);
  }
}
