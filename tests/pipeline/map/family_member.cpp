// A family's model asked about one vehicle: the same answers at the same numbers without dimension, at any size and
// gravity, in closed form and through files.
#include "pipeline/map/family_member.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/files/file.h"
#include "base/json/config.h"
#include "base/math/random.h"
#include "learning/score/score.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/active/learning_curve.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/training/teacher.h"
#include "pipeline/outcome/training/train_model.h"
#include "pipeline/outcome/training_data.h"
#include "terrain/raster/layer/slope.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/made_shapes.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "vehicle/family/driveline_share.h"
#include "vehicle/family/vehicle_numbers.h"
#include "vehicle/model/statics.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
namespace fs = std::filesystem;

namespace {

const fs::path kConfigs = fs::path(GONOGO_SOURCE_DIR) / "configs";

std::size_t index(const char* name) { return contract().variable_index(name); }
std::size_t measure(const char* name) { return contract().measure_index(name); }

vehicle::Family wheeled() { return vehicle::read_family(Config::read(kConfigs / "families/wheeled.json")); }

/// Numbers of the HMMWV at the Earth, so that members of any size can be made with them.
vehicle::VehicleNumbers some_numbers() {
  vehicle::VehicleNumbers n =
      vehicle::vehicle_numbers(vehicle::read_vehicle(kConfigs / "vehicles/hmmwv.json"), kGravity);
  n.top_speed = 3;
  return n;
}

/// The vehicle with these numbers whose wheels have a diameter of `diameter` [m].
vehicle::Vehicle vehicle_of(double diameter, double gravity, const vehicle::VehicleNumbers& numbers = some_numbers()) {
  vehicle::Family family = wheeled();
  family.diameter = diameter;
  return vehicle::canonical_vehicle(family, numbers, gravity);
}

FamilyMember member_of(double diameter, double gravity) {
  return family_member(wheeled(), kGravity, vehicle_of(diameter, gravity), gravity);
}

std::vector<double> point_of(std::initializer_list<std::pair<const char*, double>> values) {
  std::vector<double> point(contract().variables.size(), 0);
  for (const auto& [name, value] : values) point[index(name)] = value;
  return point;
}

/// The family's ranges, as a box of its trials.
std::vector<Range> sampled_by(const FamilyMember& member) {
  std::vector<Range> sampled(contract().variables.size());
  for (const vehicle::PlacedNumber& n : vehicle::placed(member.family, member.numbers))
    if (n.name != "top_speed_number") sampled[index(n.name.c_str())] = n.range;
  return sampled;
}

void set_numbers(std::vector<double>& point, const FamilyMember& member) {
  for (const auto& [name, spread] : family_values(member, sampled_by(member))) point[index(name.c_str())] = spread.low;
}

}  // namespace

TEST_CASE("vehicles of equal numbers put equal questions to their family, at every size and gravity") {
  const double base_cohesion = 3, base_bed = 0.2, base_speed = 2;
  for (const double diameter : {0.25, 1.0, 1.7})
    for (const double gravity : {kGravity, 3.71, 1.62}) {
      INFO(diameter << " m, " << gravity << " m/s2");
      const FamilyMember member = member_of(diameter, gravity);
      const double stress = gravity * diameter / kGravity;
      std::vector<double> point = point_of({{"slope_along", 12},
                                            {"friction_angle", 31},
                                            {"cohesion", base_cohesion * stress},
                                            {"bed_depth", base_bed * diameter},
                                            {"commanded_speed", base_speed * std::sqrt(stress)}});
      set_numbers(point, member);
      const std::vector<double> asked = family_point(member, point);
      CHECK(asked[index("slope_along")] == 12);
      CHECK(asked[index("friction_angle")] == 31);
      CHECK(asked[index("cohesion")] == Approx(base_cohesion));
      CHECK(asked[index("bed_depth")] == Approx(base_bed));
      CHECK(asked[index("commanded_speed")] == Approx(base_speed));
      CHECK(asked[index("load_number")] == Approx(some_numbers().wheel.load).epsilon(1e-6));
      CHECK(asked[index("force_number")] == Approx(some_numbers().force).epsilon(1e-4));
    }
}

TEST_CASE("a payload is a heavier vehicle: the numbers are those of the vehicle with that mass") {
  const double mass = member_of(0.9, kGravity).mass;
  const FamilyMember member = member_of(0.9, kGravity);
  std::vector<double> point = point_of({{"payload", 0.2 * mass}});
  set_numbers(point, member);
  const std::vector<double> asked = family_point(member, point);
  vehicle::VehicleNumbers heavy = some_numbers();
  heavy.wheel.load *= 1.2;
  const vehicle::Vehicle loaded = vehicle_of(0.9, kGravity, heavy);
  CHECK(vehicle::weigh(loaded).total == Approx(1.2 * mass));
  CHECK(asked[index("load_number")] == Approx(vehicle::vehicle_numbers(loaded, kGravity).wheel.load));
  CHECK(asked[index("deflection_ratio")] == Approx(1.2 * point[index("deflection_ratio")]));
  CHECK(asked[index("power_number")] == Approx(point[index("power_number")] / 1.2));
  CHECK(asked[index("payload")] == 0);
  const vehicle::VehicleNumbers same = vehicle::loaded(some_numbers(), 1.2);
  CHECK(asked[index("force_number")] == Approx(same.force));
}

TEST_CASE("a driveline that shares torque asks for a steeper slope, at each slope alike") {
  FamilyMember member = member_of(0.9, kGravity);
  member.vehicle.driveline.wheel_motors = false;
  member.vehicle.driveline.centre = vehicle::Differential::open;
  const auto felt = [&](double slope) {
    return family_point(member, point_of({{"slope_along", slope}}))[index("slope_along")];
  };
  CHECK(felt(-12) == -12);
  CHECK(felt(12) > 12.2);
  // A model whose distance from trials tells the slope that it was asked, one by one and uphill.
  OutcomeModel family;
  family.sampled.assign(contract().variables.size(), {-45, 45});
  family.novelty = [](std::span<const double> point) { return point[index("slope_along")]; };
  family.novelty_uphill = [](std::span<const double>, std::span<const double> along, std::span<double> result) {
    std::copy(along.begin(), along.end(), result.begin());
  };
  const OutcomeModel model = model_of_member(family, {}, member);
  const std::vector<double> along = {-12, 0, 12, 20};
  std::vector<double> uphill(along.size());
  model.novelty_uphill(point_of({}), along, uphill);
  for (std::size_t k = 0; k < along.size(); ++k)
    CHECK(uphill[k] == model.novelty(point_of({{"slope_along", along[k]}})));
  // A trial of the family is one of the member on the slope that feels so.
  TrialRecord record;
  record.point.variables = point_of({{"slope_along", felt(12)}});
  set_numbers(record.point.variables, member);
  record.measures.assign(contract().measures.size(), 1);
  const TrialRecord seen = trials_of_member({{record}, {}}, member).records.front();
  CHECK(seen.point.variables[index("slope_along")] == Approx(12).epsilon(1e-9));
}

TEST_CASE("measures come back at the member's scale, and its own trial keeps slip and share of the weight") {
  const FamilyMember member = member_of(0.5, 1.62);
  TrialRecord record;
  record.point.variables = point_of({{"cohesion", 4}, {"commanded_speed", 2}});
  set_numbers(record.point.variables, member);
  record.verdict = Verdict::go;
  record.measures.assign(contract().measures.size(), 1);
  const vehicle::Vehicle canonical = vehicle_of(1, kGravity);
  const double weight = vehicle::weigh(canonical).total * kGravity, own = member.mass * 1.62;
  record.measures[measure("energy_per_metre")] = 0.3 * weight;
  record.measures[measure("mean_torque")] = 0.1 * weight * 0.5 / 4;  // on each of 4 wheels with a radius of 0.5 m
  record.measures[measure("slip")] = 0.25;
  const Dataset trials = trials_of_member({{record}, {}}, member);
  const TrialRecord& seen = trials.records.front();
  CHECK(seen.measures[measure("energy_per_metre")] == Approx(0.3 * own));
  CHECK(seen.measures[measure("mean_torque")] == Approx(0.1 * own * 0.25 / 4));
  CHECK(seen.measures[measure("slip")] == 0.25);
  CHECK(seen.measures[measure("sinkage")] == Approx(0.5));
  CHECK(seen.measures[measure("mean_speed")] == Approx(std::sqrt(0.5 * 1.62 / kGravity)));
  CHECK(seen.measures[measure("drive_time")] == Approx(std::sqrt(0.5 * kGravity / 1.62)));
  CHECK(seen.point.variables[index("cohesion")] == Approx(4 * 0.5 * 1.62 / kGravity));
  CHECK(seen.verdict == Verdict::go);
}

TEST_CASE("a member's own trials are points of its family: payload as load, soil and speed at the family's scale") {
  const FamilyMember member = member_of(0.5, 1.62);
  const std::vector<Range> sampled = sampled_by(member);
  TrialRecord record;
  record.point.variables = point_of({{"slope_along", 7}, {"cohesion", 4}, {"payload", 0.25 * member.mass}});
  record.measures.assign(contract().measures.size(), 1);
  record.verdict = Verdict::no_go;
  const TrialRecord seen = trials_in_family({{record}, {}}, member, sampled).records.front();
  CHECK(seen.point.variables[index("slope_along")] == 7);
  CHECK(seen.point.variables[index("cohesion")] == Approx(4 * kGravity / 1.62 / 0.5));
  CHECK(seen.point.variables[index("payload")] == 0);
  CHECK(seen.point.variables[index("load_number")] == Approx(1.25 * some_numbers().wheel.load));
  CHECK(seen.point.variables[index("power_number")] == Approx(member.numbers.power / 1.25));
  CHECK(seen.verdict == Verdict::no_go);
}

namespace {

/// Trials of the family drawn from a closed form: heavy wheels and steep slopes stop. The first two lie at the ends.
std::vector<TrialRecord> made_trials() {
  std::vector<TrialRecord> records;
  for (std::uint64_t i = 0; i < 400; ++i) {
    TrialRecord record;
    std::vector<double>& x = record.point.variables;
    x.assign(contract().variables.size(), 0);
    const auto draw = [&](const char* name, double low, double high) {
      x[index(name)] = i < 2 ? (i == 0 ? low : high) : low + (high - low) * random_unit(5, i, index(name));
    };
    draw("slope_along", -20, 30);
    draw("friction_angle", 20, 40);
    draw("cohesion", 0, 15);
    draw("load_number", 0.3, 5);
    for (const vehicle::PlacedNumber& n : vehicle::placed(wheeled(), some_numbers()))
      if (n.name != "top_speed_number" && n.name != "load_number")
        draw(n.name.c_str(), n.range.minimum, n.range.maximum);
    draw("axles", 1.5, 4.5);
    draw("relative_density", 0, 1);
    draw("tyre_friction", 0.3, 1);
    draw("bed_depth", 0.13, 0.3);
    draw("commanded_speed", 1.2, 3);
    const double p = 1 / (1 + std::exp(1.2 * (x[index("load_number")] - 2) + 0.15 * x[index("slope_along")] -
                                       0.3 * (x[index("cohesion")] - 5)));
    record.point.index = record.point.seed = i;
    const bool go = random_unit(5, i, 100) < p;
    record.verdict = go ? Verdict::go : Verdict::no_go;
    record.reason = go ? Reason::none : Reason::sinkage;
    record.measures.assign(contract().measures.size(), 0.1);
    records.push_back(record);
  }
  return records;
}

/// data/family/dataset.h5 and model.h5 of a folder, trained once.
fs::path copy_family(const TemporaryFolder& folder) {
  const fs::path place = folder.path() / "data/family";
  fs::create_directories(place);
  const Provenance provenance{.study = R"({"study": "made", "seed": 1, "trial": {"compliant_tyres": true}})",
                              .contract_hash = "",
                              .program_version = "",
                              .backend = "cpu",
                              .inputs = {},
                              .libraries = {},
                              .files = {{"vehicle", read_file(kConfigs / "families/wheeled.json")},
                                        {"calibration", read_file(kConfigs / "soils/calibration_32mm.json")}}};
  write_dataset(place / "dataset.h5", {made_trials(), provenance});
  static const std::string trained = [&] {
    const Config quick = Config::parse(R"({"hidden": 4, "epochs": 40, "folds": 2})", "learning");
    outcome::train_model(
        {.dataset = place / "dataset.h5", .model = place / "model.h5", .seed = 3, .learning = quick, .design = {}});
    return read_file(place / "model.h5");
  }();
  write_file_atomically(place / "model.h5", trained);
  return place / "model.h5";
}

void write_region(const TemporaryFolder& folder, const std::string& keys = "") {
  test::make_flat_ground(folder);
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "flat",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "s", "licence": "l"}],
    "values": {"friction_angle": {"fixed": 30, "source": "s"}, "cohesion": {"fixed": 4, "source": "s"},
               "relative_density": {"fixed": 0.5, "source": "s"}, "bed_depth": {"fixed": 0.235, "source": "s"},
               "tyre_friction": {"fixed": 0.8, "source": "s"}, "payload": {"fixed": 0, "source": "s"},
               "commanded_speed": {"fixed": 1.939, "source": "s"}},
    "texture": "sand")" + keys + "}");
}

MapFiles files_of(const TemporaryFolder& folder, const fs::path& model, const std::string& vehicle,
                  const std::string& out) {
  MapFiles files;
  files.model = model;
  files.region = folder / "region.json";
  files.vehicle = vehicle;
  files.out = folder / out;
  return files;
}

bool says(const MapSummary& summary, const std::string& text) {
  return std::any_of(summary.remarks.begin(), summary.remarks.end(),
                     [&](const std::string& remark) { return contains(remark, text); });
}

}  // namespace

TEST_CASE("a map of a vehicle that no trial drove is answered by its machine, which its family's teacher taught") {
  const TemporaryFolder folder;
  const fs::path model = copy_family(folder);
  write_region(folder);
  const MapFiles files = files_of(folder, model, "hmmwv", "map");
  const MapRequest request = read_map_request(files);
  const vehicle::Vehicle hmmwv = vehicle::read_vehicle(kConfigs / "vehicles/hmmwv.json");
  const double diameter = 2 * hmmwv.wheel.front().radius;
  const MapSummary summary = make_map(request);
  CHECK(says(summary, "no trial drove the vehicle hmmwv: 400 trials of other vehicles of the family wheeled_family"));
  std::vector<double> point = point_of({{"friction_angle", 30},
                                        {"cohesion", 4},
                                        {"relative_density", 0.5},
                                        {"tyre_friction", 0.8},
                                        {"bed_depth", 0.235},
                                        {"commanded_speed", 1.939}});
  const FamilyMember member = family_member(wheeled(), kGravity, hmmwv, kGravity);
  const TrainedModel family = read_trained_model(model);
  const auto machine = machine_of_member(model, *family.predictor, member, sampled_box(family));
  const terrain::Tile p_go = terrain::RasterSource::open_as_it_lies(files.out / "p_go.tif").read({5, 5, 1, 1});
  const auto dem = terrain::RasterSource::open_elevation(folder / "dem.tif");
  const terrain::Tile slope = terrain::slope_degrees(dem.read({4, 4, 3, 3}), {10, 10});
  point[index("slope_along")] = rounded_slope(slope.at(0, 0));
  CHECK(p_go.at(0, 0) == Approx(machine->p_go(point)).margin(1e-6));

  // The teacher, asked at the vehicle's numbers and the family's scale.
  std::vector<double> asked = point_of({{"friction_angle", 30},
                                        {"cohesion", 4 / diameter},
                                        {"relative_density", 0.5},
                                        {"tyre_friction", 0.8},
                                        {"bed_depth", 0.235 / diameter},
                                        {"commanded_speed", 1.939 / std::sqrt(diameter)}});
  set_numbers(asked, member);
  asked[index("slope_along")] =
      to_degrees(vehicle::felt_slope(hmmwv, member.numbers, to_radians(rounded_slope(slope.at(0, 0)))));
  CHECK(p_go.at(0, 0) == Approx(outcome::Teacher::read(model)(asked)[0]).margin(0.05));
}

TEST_CASE("the teacher in the file of a family's model answers as the one that taught it, to the last bit") {
  const TemporaryFolder folder;
  const fs::path model = copy_family(folder);
  const learning::TrainingTable table = outcome::make_training_data(made_trials(), {}).table;
  const outcome::Teacher taught(table, {}), read = outcome::Teacher::read(model);
  CHECK(read(table.variables) == taught(table.variables));
  CHECK(read.of_many(table.variables) == taught.of_many(table.variables));
  const std::string hmmwv = (fs::path(GONOGO_SOURCE_DIR) / "data/hmmwv_32mm/model.h5").string();
  CHECK(contains(input_error([&] { outcome::Teacher::read(hmmwv); }),
                 "holds no teacher, which answers for single vehicles; train the model again"));
}

TEST_CASE("a machine of one vehicle follows the shipped family's teacher, and its rows pass as often") {
  const TrainedModel family = read_trained_model(find_model("wheeled_family_32mm"));
  const outcome::Teacher teacher = outcome::Teacher::read(family.file);
  const vehicle::Vehicle fed = vehicle::read_vehicle(kConfigs / "vehicles/fed_alpha.json");
  const FamilyMember member = family_member(*family.family, family.gravity, fed, kGravity);
  const std::vector<Range> box = sampled_box(family);
  const auto answers = machine_of_member(family.file, *family.predictor, member, box);
  const learning::Model samples = model_for_vehicle("wheeled_family_32mm", fed, kGravity);
  CHECK(samples.provenance.at("member").string() == "fed_alpha");
  // Points of its box, put to the teacher in the family's numbers.
  const learning::Model& machine = answers->model();
  double of_answers = 0, of_samples = 0, passable = 0;
  const outcome::Predictor drawn(samples);
  constexpr std::size_t kAsked = 1000;
  for (std::size_t n = 0; n < kAsked; ++n) {
    std::vector<double> point(box.size());
    for (std::size_t v = 0; v < box.size(); ++v)
      point[v] =
          machine.sampled_lower[v] + (machine.sampled_upper[v] - machine.sampled_lower[v]) * random_unit(11, n, v);
    const double p = teacher(family_point(member, point))[0];
    of_answers += std::pow(answers->p_go(point) - p, 2) / kAsked;
    of_samples += std::pow(drawn.p_go(point) - p, 2) / kAsked;
    passable += p / kAsked;
  }
  std::printf("off the teacher by %.3f (answers), %.3f (samples), rms\n", std::sqrt(of_answers), std::sqrt(of_samples));
  CHECK(of_answers < 0.05 * 0.05);
  CHECK(of_samples < 0.05 * 0.05);
  // Rows of the whole machine, where nothing is known: its joint distribution passes as often as the box.
  const learning::JointAnswer all = drawn.reconstruct(std::vector<double>(box.size(), NAN), std::nullopt);
  double rows = 0;
  for (std::size_t y = 0; y < contract().outcomes.size(); ++y)
    rows += passes(contract().outcomes[y].verdict) * all.outcome.probability[y];
  CHECK(rows == Approx(passable).margin(0.04));
}

TEST_CASE("bootstrap members of a family answer by machines of the vehicle, each taught by its own teacher") {
  const TemporaryFolder folder;
  const fs::path model = copy_family(folder);
  write_region(folder);
  const Config quick = Config::parse(R"({"hidden": 4, "epochs": 40, "folds": 2})", "learning");
  MapFiles files = files_of(folder, model, "hmmwv", "map");
  files.members = outcome::train_members(
      {.dataset = model.parent_path() / "dataset.h5", .model = model, .seed = 3, .learning = quick, .design = {}}, 1);
  const MapRequest request = read_map_request(files);
  REQUIRE(request.model.members.size() == 1);
  CHECK(request.model.member_hashes == std::vector<std::string>{file_hash(files.members.front())});
  const TrainedModel family = read_trained_model(model);
  const FamilyMember member =
      family_member(wheeled(), kGravity, vehicle::read_vehicle(kConfigs / "vehicles/hmmwv.json"), kGravity);
  const auto machine = machine_of_member(files.members.front(), outcome::Predictor::read(files.members.front()), member,
                                         sampled_box(family));
  const std::vector<double> point = point_of({{"friction_angle", 30}, {"cohesion", 4}, {"payload", 0}});
  std::vector<double> answer(contract().outcomes.size()), expected(answer.size()), of_model(answer.size());
  request.model.members.front()(point, answer);
  machine->outcome_probabilities(point, expected);
  request.model.probabilities(point, of_model);
  CHECK(answer == expected);
  CHECK(answer != of_model);
}

TEST_CASE("a machine of one vehicle has the same bits for any number of threads") {
  const TemporaryFolder folder;
  const fs::path model = copy_family(folder);
  const TrainedModel family = read_trained_model(model);
  const FamilyMember member =
      family_member(wheeled(), kGravity, vehicle::read_vehicle(kConfigs / "vehicles/hmmwv.json"), kGravity);
  const int usual = omp_get_max_threads();
  std::vector<std::vector<double>> weights;
  for (const int threads : {1, 3}) {
    omp_set_num_threads(threads);
    weights.push_back(machine_of_member(model, *family.predictor, member, sampled_box(family))->model().weights.weight);
  }
  omp_set_num_threads(usual);
  CHECK(weights[0] == weights[1]);
}

TEST_CASE("a family's model is scored on trials of one vehicle at the vehicle's numbers") {
  const TemporaryFolder folder;
  const TrainedModel family = read_trained_model(copy_family(folder));
  const fs::path fresh = fs::path(GONOGO_SOURCE_DIR) / "data/hmmwv_32mm_unsolved/fresh.h5";
  const AnsweredTrials asked = answer_trials(family, fresh);
  const FamilyMember member =
      family_member(wheeled(), kGravity, vehicle::read_vehicle(kConfigs / "vehicles/hmmwv.json"), kGravity);
  std::vector<double> first = read_dataset(fresh).records.front().point.variables;
  set_numbers(first, member);
  CHECK(family_point(member, first) == asked.in_model.records.front().point.variables);
  double sum = 0;
  for (const TrialRecord& trial : asked.trials.records)
    sum += std::pow(std::min(1.0, asked.predictor->p_go(trial.point.variables)) - double(passes(trial.verdict)), 2);
  const outcome::Evaluation scored = outcome::evaluate_model(*asked.predictor, asked.trials, "fresh");
  CHECK(scored.trials == 400);
  CHECK(scored.scores.model().brier.value == Approx(sum / 400));
}

TEST_CASE("64 own trials where a family is unsure correct a forecast that leans, and the speeds of its trials help") {
  const fs::path fresh = fs::path(GONOGO_SOURCE_DIR) / "data/hmmwv_32mm_fresh/dataset.h5";
  const auto shipped = family_forecast("wheeled_family_32mm", fresh);
  // The shipped forecast leans too little for the speeds to add to it, so here its odds of passing are e times as high.
  const auto forecast = std::make_shared<outcome::Forecast>(*shipped);
  forecast->p_go = [&](const std::vector<double>& points) {
    std::vector<double> p = shipped->p_go(points);
    for (double& x : p) x = x / (x + (1 - x) * std::exp(-1.0));
    return p;
  };
  const learning::TrainingTable table = outcome::make_training_data(read_dataset(fresh).records, {}).table;
  outcome::Forecast without_speeds = *forecast;
  without_speeds.table = {};
  double alone = 0, together = 0, blind = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto groups = outcome::grown_groups(table, {}, 64, outcome::answers_of(*forecast), seed);
    std::vector<std::size_t> own, rest;
    for (std::size_t n = 0; n < table.row_count(); ++n)
      (std::binary_search(groups.begin(), groups.end(), table.group[n]) ? own : rest).push_back(n);
    const learning::TrainingTable unseen = table.subset(rest);
    const std::vector<int> happened = outcome::passable_labels(unseen);
    const auto score = [&](const std::vector<double>& p) { return learning::brier_score(p, happened) / 3; };
    const auto taught = [&](const outcome::Forecast& known) {
      outcome::OtherTrials others;
      outcome::add_forecast(others, std::make_shared<const outcome::Forecast>(known));
      return outcome::Teacher(table.subset(own), others)(unseen.variables);
    };
    alone += score(forecast->p_go(unseen.variables));
    together += score(taught(*forecast));
    blind += score(taught(without_speeds));
  }
  std::printf("Brier score of the family %.4f; with 64 own trials %.4f, without the family's speeds %.4f\n", alone,
              together, blind);
  CHECK(together < 0.9 * alone);
  CHECK(together < blind);
}

TEST_CASE(
    "trials of vehicles driven by themselves shift a family's odds of passing to theirs, each vehicle counting alike") {
  const fs::path data = fs::path(GONOGO_SOURCE_DIR) / "data";
  const TrainedModel family = read_trained_model(find_model("wheeled_family_32mm"));
  const fs::path fresh = data / "hmmwv_32mm_fresh/dataset.h5", viper = data / "viper_32mm/dataset.h5";
  const std::vector<outcome::VehicleTrials> vehicles = vehicle_trials(family.dataset_file, {}, {fresh, viper});
  REQUIRE(vehicles.size() == 2);
  CHECK(vehicles[1].vehicle == "viper");
  CHECK(vehicles[1].hash == file_hash(viper));
  const Dataset asked = answer_trials(family, viper).in_model;
  REQUIRE(vehicles[1].table.row_count() == asked.records.size());
  for (std::size_t n = 0; n < asked.records.size(); ++n)
    REQUIRE(std::equal(vehicles[1].table.row(n).begin(), vehicles[1].table.row(n).end(),
                       asked.records[n].point.variables.begin()));

  // What a shift does to the odds, and that the fitted one undoes it.
  const double found = outcome::fitted_shift(*family.predictor, vehicles), power = 1.25;
  learning::Model other = family.predictor->model();
  other.calibration_power = power;
  const outcome::Predictor before(other);
  outcome::shift_odds(other.layout, 0.7, power, other.weights);
  const outcome::Predictor after(other);
  const auto odds = [](double p) { return std::log(p / (1 - p)); };
  for (std::size_t n = 0; n < 40; ++n) {
    const double p = before.p_go(vehicles[0].table.row(n));
    if (p > 0.01 && p < 0.99) CHECK(odds(after.p_go(vehicles[0].table.row(n))) - odds(p) == Approx(0.7).margin(1e-6));
  }
  CHECK(outcome::fitted_shift(after, vehicles) == Approx(outcome::fitted_shift(before, vehicles) - 0.7).margin(1e-3));
  CHECK(outcome::fitted_shift(after, {}) == 0);

  // Where each vehicle counts alike: with the fitted shift as many pass as forecast, as the mean over vehicles.
  learning::Model fitted = family.predictor->model();
  outcome::shift_odds(fitted.layout, found, fitted.calibration_power, fitted.weights);
  const outcome::Predictor balanced(fitted);
  double excess = 0;
  for (const outcome::VehicleTrials& trials : vehicles) {
    const std::vector<int> passed = outcome::passable_labels(trials.table);
    for (std::size_t n = 0; n < passed.size(); ++n)
      excess += (balanced.p_go(trials.table.row(n)) - passed[n]) / double(passed.size());
  }
  CHECK(std::abs(excess) < 1e-3);

  CHECK(vehicle_trials(fresh, {}, {}).empty());
  CHECK(contains(input_error([&] { vehicle_trials(fresh, {}, {viper}); }), "--vehicles has no family to calibrate"));
  CHECK(contains(input_error([&] { vehicle_trials(family.dataset_file, {}, {family.dataset_file}); }),
                 "--vehicles wants trials of one vehicle"));
}

TEST_CASE("a vehicle outside its family is unknown by number and amount, with what its own model costs") {
  const TemporaryFolder folder;
  const fs::path model = copy_family(folder);
  write_region(folder);
  Json heavy = Json::read(kConfigs / "vehicles/mgru3_rover.json");
  heavy["vehicle"] = "heavy_rover";
  heavy["chassis"]["mass_kg"] = 2000.0;
  write_file_atomically(folder / "heavy.json", heavy.dump());
  const MapSummary summary =
      make_map(read_map_request(files_of(folder, model, (folder / "heavy.json").string(), "map")));
  CHECK(summary.area.share(Verdict::unknown) == 1);
  CHECK(says(summary, "heavy_rover lies outside the family, so that every cell is unknown: load_number 8.05"));
  CHECK(says(summary, "gonogo vehicle study"));
  CHECK(says(summary, "Cost: 600 trials"));
}

TEST_CASE("a lunar rover is answered at the Moon's gravity, and more force than wheels can use counts as the most") {
  const TemporaryFolder folder;
  MapFiles files;
  files.model = copy_family(folder);
  files.dem = fs::path(GONOGO_SOURCE_DIR) / "data/viper_32mm/crater.tif";
  files.soil = "grc1";
  files.vehicle = "viper";
  files.out = folder / "map";
  const MapRequest request = read_map_request(files);
  CHECK(request.model.gravity == 1.62);
  CHECK(request.rules.values.at("force_number").low < 4.01);
  CHECK(request.rules.values.at("load_number").low == Approx(1.7).epsilon(0.01));
  const MapSummary summary = make_map(request);
  CHECK(summary.gravity == 1.62);
  CHECK_FALSE(says(summary, "lies outside the family"));
  CHECK(summary.area.share(Verdict::unknown) < 1);
}

TEST_CASE("a centre of mass lower than sampled counts as the lowest, and a higher one lies outside") {
  FamilyMember member = member_of(0.9, kGravity);
  const std::vector<Range> sampled = sampled_by(member);
  const Range range = sampled[index("centre_height_ratio")];
  member.numbers.centre_height = 0.8 * range.minimum;
  CHECK(family_values(member, sampled).at("centre_height_ratio").low == range.minimum);
  CHECK(numbers_outside(member, sampled).empty());
  member.numbers.centre_height = 1.1 * range.maximum;
  REQUIRE(numbers_outside(member, sampled).size() == 1);
  CHECK(contains(numbers_outside(member, sampled).front(), "centre_height_ratio"));
}

TEST_CASE("a family's model is refused without a vehicle, for tracks, and where its trials are gone") {
  const TemporaryFolder folder;
  const fs::path model = copy_family(folder);
  write_region(folder);
  const auto refusal = [&](const std::string& vehicle) {
    return input_error([&] { read_map_request(files_of(folder, model, vehicle, "refused")); });
  };
  CHECK(contains(refusal(""), "is a model of a family, wheeled_family; name one vehicle with --vehicle"));
  CHECK(contains(refusal("m113"), "the family has whole wheeled vehicles, and this is one on tracks"));
  CHECK(read_map_request(files_of(folder, {}, "fed_alpha", "shipped")).model.vehicle == "fed_alpha");
  fs::remove(folder.path() / "data/family/dataset.h5");
  const std::string no_trials =
      "is a model of a family, and its trials, which say how vehicles are scaled, are not beside "
      "it; put their dataset.h5 into its folder";
  CHECK(contains(refusal("hmmwv"), no_trials));
  const fs::path fresh = fs::path(GONOGO_SOURCE_DIR) / "data/hmmwv_32mm_unsolved/fresh.h5";
  CHECK(contains(input_error([&] { answer_trials(read_trained_model(model), fresh); }), no_trials));
  CHECK_FALSE(fs::exists(folder / "refused"));
}
