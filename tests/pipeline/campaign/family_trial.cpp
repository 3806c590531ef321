// Trials of a family of wheels: the member that a point describes drives, and its pull is part of the record.
#include <cmath>

#include "base/files/file.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/trial/trial.h"
#include "pipeline/campaign/trial/world.h"
#include "sim/scene/flat_world.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"
#include "vehicle/model/statics.h"

namespace gonogo::campaign {
namespace {

const std::string kConfigs = std::string(GONOGO_SOURCE_DIR) + "/configs/";
const std::string kNumbers =
    R"("load_number": [0.5, 2], "width_ratio": [0.25, 0.4], "deflection_ratio": [0, 0.08], "lug_ratio": [0, 0.05],
       "single_wheel_slip": [0, 0.5], "single_wheel_slip_angle": [0, 20])";

/// A study of the family on coarse grains.
struct StudyFile {
  TemporaryFolder folder;

  Study with(const std::string& numbers = kNumbers, const std::string& vehicle = kConfigs + "families/wheeled.json",
             const std::string& tyres = "true", const std::string& task = R"({"type": "single_wheel"})") const {
    write_file_atomically(folder / "study.json", R"({"study": "wheels", "seed": 4, "vehicle": ")" + vehicle +
                                                     R"(", "soil": {"calibration": ")" + kConfigs +
                                                     R"(soils/calibration_90mm.json"},
        "trial": {"task": )" + task + R"(, "compliant_tyres": )" +
                                                     tyres + R"(,
                  "bed": {"length_m": 2.4, "width_m": 0.9, "packing_seeds": 1, "settle_s": 0.05},
                  "drive": {"park_s": 0.05, "ramp_s": 0.05, "minimum_drive_s": 0.3, "time_limit_s": 0.3},
                  "numerics": {"step_s": 2e-3, "substeps": 14, "iterations": 2, "tolerance_m_per_s": 0}},
        "design": {"method": "sobol", "points": 8, "ranges": {"friction_angle": [30, 36], )" +
                                                     numbers + R"(},
          "fixed": {"slope_along": 0, "slope_across": 0, "cohesion": 0, "relative_density": 0.5, "payload": 0,
                    "tyre_friction": 0.8, "bed_depth": 0.3, "commanded_speed": 1}}})");
    return read_study(folder / "study.json");
  }

  TrialSetup setup() const {
    return read_trial_setup(with(), std::filesystem::temp_directory_path() / "gonogo-test-beds");
  }
};

}  // namespace

TEST_CASE("every point of a family's study drives the wheel that it describes, at the slip that it gives") {
  const StudyFile file;
  const TrialSetup setup = file.setup();
  const Study study = file.with();
  for (const DesignPoint& p : make_design(read_design(study.section("design"), study.seed))) {
    const TrialSetup own = setup_at(setup, p);
    const vehicle::WheelNumbers asked = wheel_at(p);
    const double load = own.weight(0);
    const vehicle::WheelNumbers n = vehicle::wheel_numbers(own.vehicle.wheel.front(), load, own.gravity);
    CHECK(n.load == Approx(asked.load));
    CHECK(n.width == Approx(asked.width));
    CHECK(n.deflection == Approx(asked.deflection < vehicle::kNegligible ? 0 : asked.deflection));
    CHECK(*own.task->given_slip() == p.variables[contract().variable_index("single_wheel_slip")]);
    CHECK(own.task->slip_angle().has_value());
    CHECK(own.vehicle.wheel.front().width <= setup.vehicle.wheel.front().width);
  }
}

TEST_CASE("every point of a study of whole vehicles drives its vehicle on a bed where no tyre runs in another's rut") {
  const Study study = read_study(kConfigs + "studies/wheeled_family_32mm.json");
  const TrialSetup setup = read_trial_setup(study, std::filesystem::temp_directory_path() / "gonogo-test-beds");
  DesignSpec spec = read_design(study.section("design"), study.seed);
  spec.points = 128;
  int axles[5] = {};
  for (const DesignPoint& p : make_design(spec)) {
    const TrialSetup own = setup_at(setup, p);
    const vehicle::VehicleNumbers asked = vehicle_at(p), n = vehicle::vehicle_numbers(own.vehicle, own.gravity);
    ++axles[n.axles];
    CHECK(n.axles == asked.axles);
    CHECK(n.wheel.load == Approx(asked.wheel.load).epsilon(1e-3));
    CHECK(n.track == Approx(asked.track).epsilon(1e-3));
    CHECK(n.centre_behind == Approx(asked.centre_behind).epsilon(1e-3));
    const Extent e = extent_of(own);
    CHECK(own.tiles_along * own.bed_length >= e.base + 7 * e.wheel);
    CHECK(lane_gap(own.vehicle, own.tiles_across * own.bed_width) >= own.vehicle.wheel.front().width);
    terrain::check_patch(own.patch(), own.calibration.grain_diameter);
  }
  for (const int count : {axles[2], axles[3], axles[4]}) CHECK(count > 30);
}

TEST_CASE("every vehicle of the family's study can start in its world") {
  const Study study = read_study(kConfigs + "studies/wheeled_family_32mm.json");
  const TrialSetup setup = read_trial_setup(study, std::filesystem::temp_directory_path() / "gonogo-test-beds");
  DesignSpec spec = read_design(study.section("design"), study.seed);
  spec.points = 512;
  for (const DesignPoint& p : make_design(spec)) {
    const TrialSetup own = setup_at(setup, p);
    const TrialInputs in = inputs_of(p);
    // Where grains lie does not matter to the start of a vehicle: one stands for the bed.
    terrain::Packing bed{.spec = bed_spec_of(own, in), .surface = in.bed_depth};
    bed.spec.length = own.tiles_along * own.bed_length;
    bed.spec.width = own.tiles_across * own.bed_width;
    bed.grain = {{.position = {0.1, 0.1, 0.05}, .radius = 0.016}};
    const sim::SceneWorld world =
        vehicle_on_bed(own, bed, {.grain = {{.position = {0.1, 0.1, 0.05}}}}, conditions_of(own, in));
    CHECK_NOTHROW(sim::flatten(world, 0, attempt_settings(own, 1)));
  }
}

TEST_CASE("the record of a towed wheel holds its pull, and a row of text the same bits") {
  const StudyFile file;
  const Study study = file.with();
  const DesignPoint p = make_design(read_design(study.section("design"), study.seed)).front();
  const TrialRecord record = run_trial(file.setup(), p);
  REQUIRE(record.verdict != Verdict::unknown);
  REQUIRE(record.pull.size() == 1);
  CHECK(measure_of(record, "pull") == record.pull.front().pull);
  CHECK(measure_of(record, "side_force") == record.pull.front().side);
  const auto read = parse_record(to_row(record));
  REQUIRE(read);
  CHECK(measure_of(*read, "pull") == measure_of(record, "pull"));
  CHECK(read->point.variables == record.point.variables);
}

TEST_CASE("studies of families are refused in one sentence where vehicle, tyres and design do not fit") {
  const StudyFile file;
  const auto refuse = [&](const std::string& word, const auto&... changed) {
    refused([&] { read_trial_setup(file.with(changed...)); }, word);
  };
  const auto without = [](std::string numbers, const std::string& part) {
    const auto at = numbers.find(part);
    return numbers.erase(at, part.size());
  };
  refuse("width_ratio: missing; the vehicle wheeled_family is a family",
         without(kNumbers, R"("width_ratio": [0.25, 0.4], )"));
  refuse("compliant_tyres: the design has deflection_ratio up to 0.08", kNumbers, kConfigs + "families/wheeled.json",
         std::string("false"));
  refuse("the vehicle hmmwv_quarter is no family", kNumbers, kConfigs + "vehicles/hmmwv_quarter.json");
  refuse("axles: missing; the vehicle wheeled_family is a family", kNumbers, kConfigs + "families/wheeled.json",
         std::string("true"), std::string(R"({"type": "climb"})"));
  refused([] { vehicle_trial_setup(kConfigs + "families/wheeled.json", kConfigs + "soils/calibration_90mm.json"); },
          "is a family of vehicles");
}

TEST_CASE("the family's study that ships has wheels that fit its bed, and soils within reach") {
  const TrialSetup s = read_trial_setup(read_study(kConfigs + "studies/wheel_family_32mm.json"));
  CHECK(s.family);
  CHECK(s.task_varied.size() == 2);
}

}  // namespace gonogo::campaign
