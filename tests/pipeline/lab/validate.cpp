// What the validation commands compute around their trials.
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/lab/validate/drawbar.h"
#include "pipeline/lab/validate/grade.h"
#include "tests/support/catch.h"
#include "tests/support/vehicles.h"
#include "vehicle/model/statics.h"
#include "vehicle/semi_empirical/bekker_wong.h"
#include "vehicle/semi_empirical/traction.h"

namespace gonogo::lab {
using namespace campaign;
namespace {

/// Dry sand of the Land Locomotion Laboratory with another friction angle [deg] and no cohesion.
vehicle::BekkerSoil dry_sand(double friction_angle) {
  return {.n = 1.1,
          .k_c = 0.99e3,
          .k_phi = 1528.43e3,
          .cohesion = 0,
          .friction_angle = to_radians(friction_angle),
          .shear_modulus = 0.025};
}

}  // namespace

TEST_CASE("means of replicates carry their standard errors") {
  const MeanError m = mean_error({1, 2, 3, 4});
  CHECK(m.mean == 2.5);
  CHECK(m.error == Approx(std::sqrt(5.0 / 3 / 4)));
  CHECK(mean_error({7}).error == 0);
}

TEST_CASE("the band of drawbar pulls on sand holds every formula that makes it and is bounded by friction") {
  const vehicle::Vehicle v = test::shipped_vehicle("hmmwv");
  const double angle = 32, load = vehicle::weigh(v).total * kGravity / 4;
  const vehicle::BekkerSoil dry = dry_sand(angle);
  double before = -1;
  for (const double slip : {0.05, 0.2, 0.5, 0.9}) {
    const TractionBand b = sand_band(v, angle, slip);
    const auto inside = [](const double(&range)[2], double x) { return x >= range[0] - 1e-6 && x <= range[1] + 1e-6; };
    const vehicle::WheelForces f = vehicle::wheel_forces_under(dry, 0.467, 0.254, slip, load);
    CHECK(inside(b.pull, f.drawbar_pull / load));
    CHECK(inside(b.resistance, f.torque / 0.467 / load - f.drawbar_pull / load));
    const double ratio = load / (0.254 * 0.467) / 414e3;
    if (ratio >= vehicle::kMinPressureRatio) CHECK(inside(b.pull, vehicle::sand_net_traction(ratio, slip)));
    CHECK(b.pull[0] < b.pull[1]);
    // No wheel without lugs pulls more than friction and the cohesion of its footprint give.
    CHECK(b.pull[1] < std::tan(to_radians(angle)) + 0.1);
    CHECK(b.pull[1] > before);
    before = b.pull[1];
  }
}

namespace {

TrialRecord climbed(double slope, double friction_angle, double cohesion, double tyre_friction, double slip) {
  TrialRecord r;
  r.point.variables.assign(contract().variables.size(), 0);
  r.measures.assign(contract().measures.size(), 0);
  const auto set = [&](const char* name, double x) { r.point.variables[contract().variable_index(name)] = x; };
  set("slope_along", slope);
  set("friction_angle", friction_angle);
  set("cohesion", cohesion);
  set("tyre_friction", tyre_friction);
  set("bed_depth", 0.3);
  set("commanded_speed", 1.5);
  r.measures[contract().measure_index("slip")] = slip;
  r.measures[contract().measure_index("distance")] = 1.6;
  r.verdict = Verdict::slow_go;
  return r;
}

}  // namespace

TEST_CASE("a wheel that climbs by rule is inside the formulas' band, and faster and slower ones are outside it") {
  const std::filesystem::path root = GONOGO_SOURCE_DIR;
  const auto file = std::filesystem::temp_directory_path() / "gonogo-test-grade.h5";
  // The rig's 643.2 kg on a rigid wheel by Wong and Reece: the slope whose tangent is the pull over the load.
  const vehicle::BekkerSoil sand = dry_sand(terrain::angle_on_plane(30));  // as the formulas take it
  const double load = 643.2 * kGravity;
  const double pull = vehicle::wheel_forces_under(sand, 0.467, 0.254, 0.4, load).drawbar_pull / load;
  const double slope = to_degrees(std::atan(pull));
  Dataset d;
  d.records = {climbed(slope + 0.5, 30, 0, 0.8, 0.4), climbed(2.5, 30, 0, 0.8, 0.4),
               climbed(34, 30, 0, 0.8, 0.4),          climbed(10, 30, 0, 0.3, 0.4),  // the tyre slides on the soil
               climbed(10, 30, 9, 0.8, 0.4),                                         // too much cohesion
               climbed(-10, 30, 0, 0.8, 0.1)};  // downhill: counts as a label alone
  for (std::size_t k = 0; k < d.records.size(); ++k) d.records[k].point.index = k;
  write_dataset(file, d);
  const GradeReport r = grade_report({file, root / "configs/vehicles/hmmwv_quarter.json", 5, 12});
  REQUIRE(r.point.size() == 3);
  CHECK(r.point[0].band.pull[0] <= std::tan(to_radians(slope + 0.5)));
  CHECK((!r.point[0].below() && !r.point[0].above()));
  CHECK(r.point[1].below());
  CHECK(r.point[2].above());
  int trials = 0, passed = 0;
  for (const LabelCount& c : r.label) {
    trials += c.trials;
    passed += c.passed;
  }
  CHECK(trials == 4);
  CHECK(passed == 4);
  CHECK(r.go_band[0] < slope + 0.1);
  CHECK(r.go_band[1] > slope - 0.1);
  d.records.resize(1);
  d.records[0] = climbed(10, 30, 9, 0.8, 0.4);
  write_dataset(file, d);
  CHECK_THROWS_AS(grade_report({file, root / "configs/vehicles/hmmwv_quarter.json", 5, 12}), InputError);
  std::filesystem::remove(file);
}

}  // namespace gonogo::lab
