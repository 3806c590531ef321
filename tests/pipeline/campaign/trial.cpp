// Gravity in the frame of the bed, and trials that end as they must.
#include "pipeline/campaign/trial/trial.h"

#include <cmath>
#include <cstring>
#include <filesystem>

#include "base/error.h"
#include "base/units.h"
#include "pipeline/campaign/trial/world.h"
#include "tests/support/catch.h"
#include "tests/support/short_trial.h"

namespace gonogo::campaign {

namespace {

TrialSetup demo_setup(const std::filesystem::path& cache) {
  TrialSetup s =
      read_trial_setup(read_study(std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/studies/demo.json"), cache);
  s.bed_length = 1.8;  // short runs: what is tested needs no test distance
  s.run_in_distance = 0.2;
  s.test_distance = 0.6;
  s.min_drive_time = 0.6;
  s.thresholds.immobile_time = 0.3;
  return s;
}

DesignPoint point(double slope, double friction_angle) { return design_point(slope, friction_angle, 0.25); }

std::filesystem::path cache() { return std::filesystem::temp_directory_path() / "gonogo-test-beds"; }

}  // namespace

TEST_CASE("gravity in the bed's frame is -g (sin s cos psi, sin s sin psi, cos s) for every slope and heading") {
  for (double s = 0; s <= 40; s += 5)
    for (double psi = -180; psi <= 180; psi += 15) {
      const double slope = to_radians(s), heading = to_radians(psi);
      const double along = to_degrees(std::atan(std::tan(slope) * std::cos(heading)));
      const double across = to_degrees(std::atan(std::tan(slope) * std::sin(heading)));
      const Vec3d g = bed_gravity(along, across);
      CHECK(g.x == Approx(-kGravity * std::sin(slope) * std::cos(heading)).margin(1e-12));
      CHECK(g.y == Approx(-kGravity * std::sin(slope) * std::sin(heading)).margin(1e-12));
      CHECK(g.z == Approx(-kGravity * std::cos(slope)));
      CHECK(length(bed_gravity(along, across, 1.62)) == Approx(1.62));
    }
}

TEST_CASE("sinkage is counted from where the wheel would roll over the grains without load") {
  // A row of equal grains a pitch apart under the middle of the wheel: the axle moves on arcs of radius R + r about
  // their centres, in the mean at (p/2 root(a^2 - p^2/4) + a^2 asin(p / 2a)) / p over them with a = R + r.
  terrain::Packing row;
  const double radius = 0.045, pitch = 0.12, reach = 0.4, arc = radius + reach;
  row.spec.length = 30 * pitch;
  row.spec.width = 1;
  row.spec.grain_diameter = 2 * radius / 50;
  for (int i = 0; i < 30; ++i) row.grain.push_back({{(i + 0.3) * pitch, 0.6, 0.2}, radius});
  const double half = pitch / 2;
  const double mean = (half * std::sqrt(arc * arc - half * half) + arc * arc * std::asin(half / arc)) / pitch;
  CHECK(untouched_axle_height(row, reach, 0.2, 0.5, 0, row.spec.length) == Approx(0.2 + mean).epsilon(1e-6));
  // Grains beyond the wheel's side by half their radius are met where their section is smaller.
  const double met = reach + radius * std::sqrt(0.75);
  const double edge = (half * std::sqrt(met * met - half * half) + met * met * std::asin(half / met)) / pitch;
  CHECK(untouched_axle_height(row, reach, 0.2, 0.5 - radius / 2, 0, row.spec.length) ==
        Approx(0.2 + edge).epsilon(1e-6));
  // Through the periodic side, and beyond its reach.
  CHECK(untouched_axle_height(row, reach, 0.2, 1.6, 0, row.spec.length) == Approx(0.2 + mean).epsilon(1e-6));
  CHECK(untouched_axle_height(row, reach, 0.2, 0.4, 0, row.spec.length) == Approx(reach).epsilon(1e-12));
}

TEST_CASE("a wheel passes level strong soil and fails on a slope that its weak soil cannot carry") {
  const TrialSetup setup = demo_setup(cache());
  const DesignPoint easy = point(0, 44), hard = point(32, 18);
  prepare_trials(setup, std::vector<DesignPoint>{easy, hard}, 2);
  const TrialRecord go = run_trial(setup, easy), stuck = run_trial(setup, hard);
  CHECK(go.verdict == Verdict::go);
  CHECK(measure_of(go, "slip") < 0.3);
  CHECK(measure_of(go, "distance") >= setup.test_distance);
  CHECK(stuck.verdict == Verdict::no_go);
  CHECK(measure_of(stuck, "mean_speed") < measure_of(go, "mean_speed"));
  for (const TrialRecord& r : {go, stuck}) {
    CHECK(measure_of(r, "worst_residual") <= setup.thresholds.residual);
    CHECK(measure_of(r, "energy_error") <= setup.thresholds.energy_error);
  }
  const TrialRecord again = run_trial(setup, easy);
  REQUIRE(again.measures.size() == go.measures.size());
  // Same point, same bits; NaN stands for measures of other types of trial.
  CHECK(std::memcmp(again.measures.data(), go.measures.data(), go.measures.size() * sizeof(double)) == 0);
}

TEST_CASE("a quarter of the gravity and half of the speeds drive the same way in twice the time") {
  // Masses and lengths stay, times double: forces are a quarter, rates half. Powers of two keep every bit.
  const TrialSetup earth = demo_setup(cache());
  TrialSetup slow = earth;
  slow.gravity = kGravity / 4;
  vehicle::LinearSpring& spring = slow.vehicle.suspension.front().upright_spring;
  for (double* force : {&spring.stiffness, &slow.vehicle.driveline.engine.value.front()}) *force /= 4;
  for (double* rate :
       {&spring.damping, &slow.thresholds.creep_speed, &slow.thresholds.immobile_speed, &slow.thresholds.residual})
    *rate /= 2;
  for (double* time : {&slow.bed_settle_time, &slow.park_time, &slow.ramp_time, &slow.min_drive_time, &slow.time_limit,
                       &slow.thresholds.immobile_time, &slow.numerics.step})
    *time *= 2;
  DesignPoint p = point(6, 40);
  prepare_trials(earth, {&p, 1}, 2);
  const TrialRecord fast = run_trial(earth, p);
  p.variables[contract().variable_index("commanded_speed")] /= 2;
  const TrialRecord same = run_trial(slow, p);
  CHECK(fast.verdict == same.verdict);
  CHECK(fast.attempts == same.attempts);
  for (const char* length : {"slip", "sinkage", "distance", "drift"})
    CHECK(measure_of(same, length) == Approx(measure_of(fast, length)).epsilon(1e-9));
  CHECK(measure_of(same, "drive_time") == Approx(2 * measure_of(fast, "drive_time")).epsilon(1e-9));
  CHECK(measure_of(same, "mean_speed") == Approx(measure_of(fast, "mean_speed") / 2).epsilon(1e-9));
  for (const char* force : {"mean_torque", "energy_per_metre"})
    CHECK(measure_of(same, force) == Approx(measure_of(fast, force) / 4).epsilon(1e-9));
}

TEST_CASE("the lunar study that ships has the Moon's gravity, a bed for its rover and soils within reach") {
  const Study study = read_study(std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/studies/viper_32mm.json");
  const TrialSetup setup = read_trial_setup(study, cache());
  CHECK(setup.gravity == 1.62);
  CHECK(setup.weight(60) == Approx((440 + 60) * 1.62));
  CHECK(setup.name == "viper-32mm");
}

TEST_CASE("a trial whose residual check cannot be met is unknown after a second attempt, never no_go") {
  TrialSetup setup = demo_setup(cache());
  setup.thresholds.residual = 1e-9;
  const DesignPoint p = point(32, 18);
  prepare_trials(setup, {&p, 1}, 1);
  const TrialRecord r = run_trial(setup, p);
  CHECK(r.verdict == Verdict::unknown);
  CHECK(r.reason == Reason::simulation_failed);
  CHECK(r.failed_checks == check_residual);
  CHECK(r.attempts == 2);
}

TEST_CASE("a slope steeper than its loose soil can stand fails before the vehicle acts") {
  const TrialSetup setup = demo_setup(cache());
  const DesignPoint p = point(44, 18);
  prepare_trials(setup, {&p, 1}, 1);
  const TrialRecord r = run_trial(setup, p);
  CHECK(r.verdict == Verdict::no_go);
  CHECK(r.reason == Reason::slope_unstable);
  CHECK(measure_of(r, "bed_creep") > setup.thresholds.creep_speed);
}

}  // namespace gonogo::campaign
