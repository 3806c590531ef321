// Whole vehicles on granular beds through the same trial as the quarter vehicle, and trials on a moving patch.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/trial/judge.h"
#include "pipeline/campaign/trial/trial.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/locked_grains.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/short_trial.h"
#include "tests/support/temporary_folder.h"
#include "vehicle/family/data_sheet.h"

namespace gonogo::campaign {

namespace {

namespace fs = std::filesystem;
using test::agrees;

/// A shipped study's text, so that it can lie in another folder than configs/studies.
std::string with_whole_paths(std::string text) {
  const std::string root = std::string(GONOGO_SOURCE_DIR) + "/";
  for (const auto& [relative, whole] : {std::pair{"../../", root}, std::pair{"../", root + "configs/"}})
    for (auto at = text.find(relative); at != std::string::npos; at = text.find(relative, at + whole.size()))
      text.replace(at, std::strlen(relative), whole);
  return text;
}

/// A vehicle on grains far too coarse for a label, so that a test is short.
TrialSetup coarse_vehicle(const std::string& vehicle, const std::string& task) {
  const fs::path root = GONOGO_SOURCE_DIR;
  TrialSetup s =
      vehicle_trial_setup(root / "configs/vehicles" / (vehicle + ".json"), root / "configs/soils/calibration_90mm.json",
                          parse_task(task), {}, fs::temp_directory_path() / "gonogo-test-beds");
  const double length = s.tiles_along * s.bed_length;
  s.calibration.grain_diameter = 0.2;
  s.bed_length = 2.2;
  s.bed_width = 1.6;
  s.tiles_along = std::max(4, int(std::ceil(length / s.bed_length)));
  s.tiles_across = 2;
  s.bed_settle_time = 0.05;
  s.park_time = 0.3;
  s.ramp_time = 0.2;
  s.min_drive_time = 0.2;
  s.run_in_distance = 0.1;
  s.test_distance = 0.4;
  s.time_limit = 1.2;
  s.numerics = {4e-3, 1, 100, 0.01};
  return s;
}

TrialSetup coarse_hmmwv(const std::string& task = "climb") { return coarse_vehicle("hmmwv", task); }

bool same(const TrialRecord& a, const TrialRecord& b) {
  return a.verdict == b.verdict && a.reason == b.reason &&
         std::memcmp(a.measures.data(), b.measures.data(), a.measures.size() * sizeof(double)) == 0;
}

/// A quarter vehicle on a moving patch.
TrialSetup moving_rig() {
  TrialSetup s = short_setup(0.5);
  s.bed_length = 3;
  s.moving_patch = true;
  return s;
}

/// Belts settle backwards while the vehicle is let down. Its slip must forget that: over 0.25 s of driving forward,
/// which no wheel outruns, it is at most 1.
void check_recent_slip(const std::vector<TrialSample>& samples, double step) {
  const auto window = std::size_t(std::lround(0.25 / step));
  REQUIRE(samples.size() > 2 * window);
  double largest = -1;
  for (std::size_t k = window; k < samples.size(); ++k)
    if (samples[k].x > samples[k - window].x) largest = std::max(largest, samples[k].slip);
  CHECK(largest <= 1);
  CHECK(largest > 0);
}

}  // namespace

TEST_CASE("a HMMWV drives over a bed of tiles, and each of its wheels has its record") {
  const TrialSetup setup = coarse_hmmwv();
  const DesignPoint p = design_point(0, 36, 0.4);
  prepare_trials(setup, {&p, 1}, 1);
  const TrialRecord r = run_trial(setup, p);
  INFO(contract().info(r.reason).name);
  CHECK(r.verdict != Verdict::unknown);
  REQUIRE(r.wheels.size() == 4);
  CHECK(r.wheels[0].name == "front left");
  double torque = 0;
  for (const WheelRecord& w : r.wheels) {
    CHECK(std::isfinite(w.slip));
    CHECK(std::fabs(w.sinkage) < 0.3);
    torque += w.torque / 4;
  }
  CHECK(agrees("mean torque of the wheels [N m]", measure_of(r, "mean_torque"), torque, 1e-6 * std::fabs(torque)));
  CHECK(measure_of(r, "distance") > 0);
  CHECK(grains_per_tyre(setup) < kGrainsPerTyre);
}

TEST_CASE("an M113 drives over a bed on its belts: road wheels sink, sprockets drive and roll by teeth times pitch") {
  const TrialSetup setup = coarse_vehicle("m113", "climb");
  const DesignPoint p = design_point(0, 36, 0.4);
  prepare_trials(setup, {&p, 1}, 1);
  std::vector<TrialSample> samples;
  TrialWatch watch;
  watch.sample = [&](const TrialSample& s) { samples.push_back(s); };
  const TrialRecord r = run_trial(setup, p, watch);
  check_recent_slip(samples, setup.numerics.step);
  INFO(contract().info(r.reason).name);
  CHECK(r.verdict != Verdict::unknown);
  REQUIRE(r.wheels.size() == 12);
  double torque = 0, sinkage = 0;
  for (std::size_t i = 0; i < r.wheels.size(); ++i) {
    const WheelRecord& w = r.wheels[i];
    const bool sprocket = i >= 10;
    CHECK(std::isfinite(w.slip) == sprocket);
    CHECK(std::isfinite(w.sinkage) != sprocket);
    if (sprocket)
      torque += w.torque / 2;
    else
      sinkage += w.sinkage / 10;
  }
  CHECK(r.wheels[10].name == "left sprocket");
  CHECK(torque > 0);
  CHECK(agrees("mean torque of the sprockets [N m]", measure_of(r, "mean_torque"), torque, 1e-6 * torque));
  CHECK(agrees("mean sinkage of the road wheels [m]", measure_of(r, "sinkage"), sinkage, 1e-6));
  CHECK(std::fabs(sinkage) < 0.15);
  CHECK(measure_of(r, "distance") > 0);
  CHECK(grains_per_tyre(setup) == 0.381 / 0.2);
}

TEST_CASE("a HMMWV stands before what a trial's type puts in its way, with all wheels on the ground") {
  for (const char* task : {"side_slope", "drawbar", "step:height_m=0.2,length_m=1", "ditch:width_m=1,depth_m=0.2",
                           "crossing:length_m=1.5,friction_angle_deg=20"}) {
    const TrialSetup setup = coarse_hmmwv(task);
    const DesignPoint p = design_point(0, 36, 0.4);
    prepare_trials(setup, {&p, 1}, 1);
    const terrain::Packing bed = settled_bed(setup, inputs_of(p));
    TiltedBed tilted;
    for (const terrain::Grain& g : bed.grain) tilted.grain.push_back({g.position});
    const sim::SceneWorld world = vehicle_on_bed(setup, bed, tilted, conditions_of(setup, inputs_of(p)));
    const auto s = sim::make_simulation(sim::Backend::cpu, {world}, attempt_settings(setup, 1), 1);
    s->advance(Index(std::lround((setup.park_time + 0.2) / setup.numerics.step)));
    INFO(task);
    CHECK(s->report(0).flags == 0);
    CHECK(s->stop(0).cause == sim::StopCause::none);
    const Course course = setup.course(bed.surface);
    CHECK(setup.task->obstacle_end() + course.front + course.rear <= course.length);
    double load[4] = {}, sum = 0;
    constexpr int steps = 40;  // it still bounces a little
    for (int k = 0; k < steps; ++k) {
      s->advance(1);
      for (int i = 0; i < 4; ++i) load[i] += s->contact_force(0, world.monitor[std::size_t(i) + 1].body).z / steps;
    }
    for (int i = 0; i < 4; ++i) {
      CHECK(load[i] > 500);
      CHECK(std::fabs(s->monitor(0, i + 1).now.drop) < 0.1);  // half a grain
      sum += load[i];
    }
    CHECK(agrees(std::string(task) + ": load on the wheels over the weight", 1, sum / setup.weight(0), 0.3));
  }
}

TEST_CASE("a study whose bed is narrower than its vehicle is refused") {
  Study study = read_study(fs::path(GONOGO_SOURCE_DIR) / "configs/studies/demo.json");
  study.vehicle = fs::path(GONOGO_SOURCE_DIR) / "configs/vehicles/hmmwv.json";
  try {
    read_trial_setup(study, fs::temp_directory_path() / "gonogo-test-beds");
    FAIL("accepted");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("outside the bed") != std::string::npos);
  }
}

TEST_CASE("on a folded bed a HMMWV stands as on three of it side by side") {
  TrialSetup folded = coarse_hmmwv();
  folded.calibration = test::locked_grains();
  folded.calibration.grain_diameter = 0.12;
  folded.bed_length = 2.2;
  folded.park_time = 2;
  fold_bed(folded);
  TrialSetup wide = folded;
  wide.folded = false;
  wide.tiles_across = 3;
  DesignPoint p = design_point(0, 36, 0.25);
  p.variables[contract().variable_index("slope_across")] = 8;
  prepare_trials(folded, {&p, 1}, 1);
  double load[2][4] = {}, height[2][4] = {}, apart[2] = {};
  for (int k = 0; k < 2; ++k) {
    const TrialSetup& setup = k == 0 ? folded : wide;
    const terrain::Packing bed = settled_bed(setup, inputs_of(p));
    TiltedBed tilted;
    for (const terrain::Grain& g : bed.grain) tilted.grain.push_back({g.position});
    const sim::SceneWorld world = vehicle_on_bed(setup, bed, tilted, conditions_of(setup, inputs_of(p)));
    sim::StepSettings settings = attempt_settings(setup, 1);
    settings.iterations = 150;
    settings.tolerance = 0;
    const auto s = sim::make_simulation(sim::Backend::cpu, {world}, settings, 1);
    s->advance(250);  // 1 s
    CHECK(s->report(0).flags == 0);
    constexpr int steps = 50;
    for (int t = 0; t < steps; ++t) {
      s->advance(1);
      for (int i = 0; i < 4; ++i) {
        const sim::BodyIndex wheel = world.monitor[std::size_t(i) + 1].body;
        load[k][i] += s->contact_force(0, wheel).z / steps;
        height[k][i] += s->body(0, wheel).position.z / steps;
      }
    }
    apart[k] = s->body(0, world.monitor[1].body).position.y - s->body(0, world.monitor[2].body).position.y;
  }
  CHECK(agrees("from right to left front wheel, modulo the bed [m]", 0,
               std::remainder(apart[1] - apart[0], folded.bed_width), 0.005));
  const double weight = wide.weight(0);
  for (int i = 0; i < 4; ++i) {
    CHECK(agrees("load of wheel " + std::to_string(i) + " over the weight", load[1][i] / weight, load[0][i] / weight,
                 0.02));
    CHECK(agrees("height of its axle [m]", height[1][i], height[0][i], 0.005));
  }
  CHECK(load[0][1] > 1.1 * load[0][0]);  // the right side is the lower one
}

TEST_CASE("a study that leaves its bed open gets a folded one, or one as wide as tyres too wide for that need") {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  const TemporaryFolder folder;
  const auto bed_of = [&](const std::string& vehicle, const std::string& bed) {
    write_file_atomically(folder / "study.json",
                          R"({"study": "own", "seed": 1, "vehicle": ")" + vehicle + R"(", "soil": {"calibration": ")" +
                              (configs / "soils/calibration_90mm.json").string() + R"("}, "trial": {)" + bed + "}}");
    return read_trial_setup(read_study(folder / "study.json"), fs::temp_directory_path() / "gonogo-test-beds");
  };
  vehicle::DataSheet sheet;
  sheet.name = "wide tyres";
  sheet.mass = 60;
  sheet.wheelbase = {0.6};
  sheet.track = 0.5;
  sheet.tyre = vehicle::read_tyre_size("0.35x0.2");
  sheet.power = 500;
  sheet.top_speed = 2;
  sheet.clearance = 0.1;
  sheet.sources = {"made for this test"};
  write_file_atomically(folder / "robot.json", vehicle::vehicle_file(sheet).json.dump());
  const std::string robot = folder / "robot.json", hmmwv = configs / "vehicles/hmmwv.json";
  CHECK(bed_of(hmmwv, "").folded);
  CHECK(bed_of(hmmwv, R"("bed": {"moving_patch": true})").folded);
  CHECK_FALSE(bed_of(hmmwv, R"("bed": {"width_m": 3})").folded);
  const TrialSetup wide = bed_of(robot, R"("bed": {"moving_patch": true})");
  CHECK_FALSE(wide.folded);
  CHECK(wide.bed_width == Approx(0.5 + 0.2 + 0.35));
  CHECK(bed_of(hmmwv, R"("bed": {"folded": false})").bed_width > 3);
  // What a message proposes is accepted.
  refused([&] { bed_of(robot, R"("bed": {"folded": true})"); }, "leave folded and width_m out, which gives 1.05 m");
  refused([&] { bed_of(robot, R"("bed": {"width_m": 0.4})"); }, "leave width_m and tiles_across of trial.bed out");
}

TEST_CASE("a vehicle made from a data sheet settles at its design height and drives") {
  const TemporaryFolder folder;
  vehicle::DataSheet sheet;
  sheet.name = "buggy";
  sheet.mass = 900;
  sheet.axles = 3;
  sheet.wheelbase = {1.2, 1.2};
  sheet.track = 1.4;
  sheet.tyre = vehicle::read_tyre_size("26x9-12");
  sheet.power = 50e3;
  sheet.top_speed = 25;
  sheet.clearance = 0.3;
  sheet.sources = {"made for this test"};
  write_file_atomically(folder / "buggy.json", vehicle::vehicle_file(sheet).json.dump());
  TrialSetup s =
      vehicle_trial_setup(folder / "buggy.json", fs::path(GONOGO_SOURCE_DIR) / "configs/soils/calibration_90mm.json");
  fold_bed(s);
  s.compliant_tyres = true;
  check_tyres(s);
  s.time_limit = s.min_drive_time = 1.5;
  s.packing_seeds = 1;
  DesignPoint p;
  p.variables = usual_values(s);
  set_value(p.variables, "friction_angle", 38, "test");
  set_value(p.variables, "commanded_speed", 1, "test");
  const TrialRecord record = run_trial(s, p);
  REQUIRE(record.verdict != Verdict::unknown);
  REQUIRE(record.wheels.size() == 6);
  CHECK(measure_of(record, "mean_speed") > 0.3);
  for (const WheelRecord& w : record.wheels) CHECK(std::fabs(w.sinkage) < 0.15);
}

TEST_CASE("a folded bed is refused where lanes would meet, for one wheel, and for tracks") {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  const auto message = [&](const std::string& vehicle, double width) {
    Study study = read_study(configs / "studies/hmmwv_32mm.json");
    study.vehicle = configs / "vehicles" / (vehicle + ".json");
    try {
      TrialSetup s = read_trial_setup(study, fs::temp_directory_path() / "gonogo-test-beds");
      CHECK(s.bed_width == Approx(2.0 / 3 * 1.8194).margin(1e-3));
      s.bed_width = width;
      check_lanes(s);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(message("hmmwv", 1.2129).empty());
  CHECK(message("hmmwv", 0.91).find("neighbouring lanes") != std::string::npos);  // left and right in one lane
  CHECK(message("hmmwv", 0.728).find("neighbouring lanes") != std::string::npos);
  CHECK(message("hmmwv_quarter", 1).find("quarter vehicle") != std::string::npos);
  CHECK(message("m113", 1).find("belts") != std::string::npos);
}

TEST_CASE("a vehicle without a study steps by the numerics of its soil's table, or by those that are asked for") {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  const auto setup = [&](const char* vehicle, const char* table, const terrain::AskedNumerics& asked) {
    return vehicle_trial_setup(configs / "vehicles" / vehicle, configs / "soils" / table, default_task(), asked);
  };
  terrain::Numerics table_32mm = terrain::usual_numerics(0.032);
  CHECK(setup("hmmwv_quarter.json", "calibration_32mm.json", {}).numerics == table_32mm);
  CHECK(setup("hmmwv.json", "calibration_90mm.json", {}).numerics == terrain::usual_numerics(0.09));
  const TrialSetup study = read_trial_setup(read_study(configs / "studies/hmmwv_32mm.json"));
  CHECK(study.numerics == table_32mm);
  terrain::AskedNumerics asked;
  asked.iterations = table_32mm.iterations = 20;
  CHECK(setup("hmmwv.json", "calibration_32mm.json", asked).numerics == table_32mm);
  const Thresholds limits = setup("hmmwv.json", "calibration_32mm.json", {}).thresholds;
  CHECK(limits.residual == study.thresholds.residual);
  CHECK(limits.energy_error == study.thresholds.energy_error);
}

TEST_CASE("a quarter vehicle's compliant tyre has the contact springs of its load; one without springs is refused") {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  TrialSetup setup =
      vehicle_trial_setup(configs / "vehicles/hmmwv_quarter.json", configs / "soils/calibration_32mm.json");
  const double payload = 800;
  DesignPoint point;
  for (const Variable& v : contract().variables) point.variables.push_back((v.minimum + v.maximum) / 2);
  point.variables[contract().variable_index("payload")] = payload;
  CHECK(conditions_of(setup, inputs_of(point)).laws.tool.stiffness == 0);
  setup.compliant_tyres = true;
  const double load = (105.5 + 537.7 + payload / 4) * 9.81, k = 163000, b = 0.254, r = 0.467, grain = 0.032;
  const double expected = 0.75 * k * grain * grain / (b * std::sqrt(2 * r * load / k));
  const auto law = conditions_of(setup, inputs_of(point)).laws.tool;
  CHECK(agrees("contact stiffness [N/m]", expected, law.stiffness, 1e-4 * expected));
  CHECK(agrees("contact damping [N s/m]", expected / k * 1000, law.damping, 1e-4 * expected / k * 1000));
  setup.vehicle.wheel.front().compliant = {};
  CHECK_THROWS_AS(check_tyres(setup), InputError);
}

TEST_CASE("grains roll on wheels as freely as the setup says, without it freely") {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  TrialSetup setup =
      vehicle_trial_setup(configs / "vehicles/hmmwv_quarter.json", configs / "soils/calibration_32mm.json");
  DesignPoint point;
  for (const Variable& v : contract().variables) point.variables.push_back((v.minimum + v.maximum) / 2);
  CHECK(conditions_of(setup, inputs_of(point)).laws.tool.rolling_friction == 0);
  setup.wheel_rolling = 0.5;
  const auto laws = conditions_of(setup, inputs_of(point)).laws;
  REQUIRE(laws.grain.rolling_friction > 0);
  CHECK(laws.tool.rolling_friction == Real(0.5) * laws.grain.rolling_friction);

  const TemporaryFolder folder;
  const auto rolling = [&](const std::string& key) {
    std::string text = read_file(configs / "studies/quarter_wheel_32mm.json");
    text.replace(text.find("\"numerics\""), 0, key);
    write_file_atomically(folder / "study.json", with_whole_paths(text));
    return read_trial_setup(read_study(folder / "study.json")).wheel_rolling;
  };
  CHECK(rolling("") == 0);
  CHECK(rolling("\"wheel_rolling\": 1, ") == 1);
  refused([&] { rolling("\"wheel_rolling\": -1, "); }, "trial.wheel_rolling");
}

TEST_CASE("a study steps by the numerics of its soil's table but for those that it names") {
  const fs::path root = GONOGO_SOURCE_DIR;
  const TemporaryFolder folder;
  const auto study_of = [&](const std::string& numerics, const std::string& table) {
    std::string text = read_file(root / "configs/studies/quarter_wheel_32mm.json");
    const auto at = text.find("\"numerics\""), end = text.find("},", at) + 2;
    text.replace(at, end - at, numerics);
    const std::string angles = R"("friction_angle": [14, 45])";
    text.replace(text.find(angles), angles.size(), R"("friction_angle": [15, 45])");
    const auto soil = text.find("../../data/quarter_wheel_32mm/calibration_32mm.json");
    text.replace(soil, std::string("../../data/quarter_wheel_32mm/calibration_32mm.json").size(), table);
    write_file_atomically(folder / "study.json", with_whole_paths(text));
    return read_trial_setup(read_study(folder / "study.json"));
  };
  const std::string table = (root / "configs/soils/calibration_32mm.json").string();
  terrain::Numerics numerics = terrain::usual_numerics(0.032);
  CHECK(study_of("", table).numerics == numerics);
  numerics.substeps = 10;
  numerics.iterations = 20;
  CHECK(study_of(R"("numerics": { "substeps": 10, "iterations": 20 },)", table).numerics == numerics);
  std::string mute = read_file(table);
  mute.replace(mute.find("\"substeps\""), 10, "\"parts\"");
  write_file_atomically(folder / "mute.json", mute);
  CHECK_THROWS_AS(study_of("", (folder / "mute.json").string()), InputError);
}

TEST_CASE("shipped studies lie within reach of their tables, and one with more cohesion than that is refused at once") {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  for (const char* study : {"demo", "quarter_wheel_32mm", "hmmwv_32mm", "hmmwv_ditch_32mm"})
    CHECK_NOTHROW(read_trial_setup(read_study(configs / "studies" / (std::string(study) + ".json"))));
  const TemporaryFolder folder;
  std::string text = read_file(configs / "studies/quarter_wheel_32mm.json");
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  };
  const auto refusal = [&] {
    write_file_atomically(folder / "study.json", text);
    try {
      read_trial_setup(read_study(folder / "study.json"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  text = with_whole_paths(text);
  CHECK(refusal().empty());
  replace("\"cohesion\": [0, 15]", "\"cohesion\": [0, 25]");
  CHECK(refusal().find("study.json: design.ranges.cohesion") != std::string::npos);
  CHECK(refusal().find("goes to 25 kPa, and at a friction angle of 14 deg") != std::string::npos);
  replace("\"friction_angle\": [14, 45]", "\"friction_angle\": [17, 45]");
  CHECK(refusal().empty());
  replace("\"friction_angle\": [17, 45]", "\"friction_angle\": [12, 45]");
  CHECK(refusal().find("design.ranges.friction_angle") != std::string::npos);
}

TEST_CASE("a single-wheel rig is refused as a whole vehicle") {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  try {
    vehicle_trial_setup(configs / "vehicles/mgru3.json", configs / "soils/calibration_90mm.json");
    FAIL("accepted");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("mgru3_wheel") != std::string::npos);
  }
}

TEST_CASE("on a moving patch a trial has the same bits alone, in company, and cut off and gone on") {
  const TemporaryFolder folder;
  const TrialSetup setup = moving_rig();
  std::vector<DesignPoint> points{design_point(0, 34, 0.2), design_point(20, 22, 0.2)};
  points[1].index = 1;
  prepare_trials(setup, points, 1);
  for (const sim::Backend backend : test::backends()) {
    const auto all = [&](int places) {
      TrialBatch batch(setup, {backend, places, 1});
      std::vector<TrialRecord> records;
      std::size_t next = 0;
      while (records.size() < points.size()) {
        for (; batch.free_places() > 0 && next < points.size(); ++next) batch.start(points[next]);
        for (TrialRecord& r : batch.advance()) records.push_back(std::move(r));
      }
      if (records[0].point.index != 0) std::swap(records[0], records[1]);
      return records;
    };
    const auto alone = all(1), together = all(2);
    for (int i = 0; i < 2; ++i) CHECK(same(alone[std::size_t(i)], together[std::size_t(i)]));
    const TrialCheckpoint saved{folder / "trial.h5", 0, false};
    fs::remove(saved.path);
    {
      TrialBatch batch(setup, {backend, 1, 1});
      batch.start(points[0], {}, saved);
      for (int k = 0; k < 9; ++k) REQUIRE(batch.advance().empty());
    }
    TrialBatch batch(setup, {backend, 1, 1});
    batch.start(points[0], {}, saved);
    std::vector<TrialRecord> ended;
    while (ended.empty()) ended = batch.advance();
    CHECK(same(ended.front(), alone[0]));
  }
}

}  // namespace gonogo::campaign
