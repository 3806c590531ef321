// Tests of one soil weighed together, envelopes at other stresses, and cone indices back to strengths.
#include "terrain/soil/evidence.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo::terrain {
namespace {

Calibration shipped_table() {
  return read_calibration(std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils/calibration_32mm.json");
}

Calibration without_cones(Calibration c) {
  for (SoilResponse& r : c.response) r.cone_gradient = 0;
  return c;
}

SoilValue fixed(double x) { return {x, x, "test", "", ""}; }
SoilValue range(double low, double high) { return {low, high, "test", "", ""}; }

SoilTest envelope(StrengthTest test, Stage stage, double angle, double cohesion) {
  SoilTest t;
  t.meaning = {.test = test, .stage = stage};
  t.friction_angle = fixed(angle);
  t.cohesion = fixed(cohesion);
  return t;
}

SoilState state(std::vector<SoilTest> tests, const std::string& texture = "") {
  SoilState s;
  s.texture = texture;
  s.relative_density = range(0, 1);
  s.bulk_density = fixed(1600);
  s.tests = std::move(tests);
  return s;
}

}  // namespace

TEST_CASE("tests of the same grains agree, and together say more than one of them") {
  const Calibration c = shipped_table();
  const std::size_t packing = 0;
  const double angle = 36;
  const auto shown = [&](StrengthTest test, Stage stage) {
    return shown_angle(c, packing, angle, {.test = test, .stage = stage});
  };
  SoilTest heap;
  heap.meaning.test = StrengthTest::repose;
  heap.friction_angle = fixed(shown(StrengthTest::repose, Stage::peak));
  const SoilTest triaxial = envelope(StrengthTest::triaxial, Stage::peak, angle, 0.5),
                 box = envelope(StrengthTest::direct_shear, Stage::peak, shown(StrengthTest::direct_shear, Stage::peak),
                                0.5 * cohesion_on_plane(angle));
  const SoilPosterior alone = soil_posterior(c, state({triaxial})),
                      all = soil_posterior(c, state({triaxial, box, heap}));
  CHECK(all.friction_angle.mean == Approx(angle).margin(1));
  CHECK(all.friction_angle.error < alone.friction_angle.error);
  CHECK(all.cohesion.mean == Approx(0.5).margin(0.2));
  CHECK(all.disagreements.empty());
  CHECK(all.evidence.size() == 5);
  double sum = 0;
  for (const double p : all.packing) sum += p;
  CHECK(sum == Approx(1));
}

TEST_CASE("a shear box and a triaxial test that show the same angle contradict each other, by name") {
  // 40 degrees on the plane are far more than 40 in triaxial compression.
  const SoilPosterior p =
      soil_posterior(shipped_table(), state({envelope(StrengthTest::triaxial, Stage::peak, 30, 0),
                                             envelope(StrengthTest::direct_shear, Stage::peak, 36, 0)}));
  REQUIRE_FALSE(p.disagreements.empty());
  CHECK(contains(p.disagreements[0], "triaxial, peak: friction angle"));
  CHECK(contains(p.disagreements[0], "direct shear, peak: friction angle"));
}

TEST_CASE("a plate adds to what a shear box says, and contradicts one of far weaker grains by name") {
  const Calibration c = shipped_table();
  const double angle = 30, depth = c.grain_diameter;
  SoilTest plate;
  plate.meaning.test = StrengthTest::plate;
  // p = k_phi z^n, so that the pressure one grain deep is that of these grains in the middle packing.
  const double n = 0.8, k_phi = plate_pressure(c, angle, 1) / 1e3 / std::pow(depth, n);
  plate.bekker = Bekker{.n = fixed(n), .k_c = fixed(0), .k_phi = fixed(k_phi)};
  const SoilTest strong = envelope(StrengthTest::triaxial, Stage::peak, angle, 0),
                 weak = envelope(StrengthTest::triaxial, Stage::peak, 17, 0);
  const SoilPosterior alone = soil_posterior(c, state({strong})), both = soil_posterior(c, state({strong, plate}));
  CHECK(both.evidence.size() == 3);
  CHECK(both.left_out.empty());
  CHECK(both.disagreements.empty());
  CHECK(both.packing[1] > alone.packing[1]);
  plate.bekker->k_phi = fixed(30 * k_phi);
  const SoilPosterior torn = soil_posterior(c, state({weak, plate}));
  REQUIRE_FALSE(torn.disagreements.empty());
  CHECK(contains(torn.disagreements[0], "plate: pressure one grain deep"));
  Calibration without = c;
  for (SoilResponse& r : without.response) r.sinkage_modulus = 0;
  const SoilPosterior none = soil_posterior(without, state({strong, plate}));
  REQUIRE(none.left_out.size() == 1);
  CHECK(contains(none.left_out[0], "holds no test of a plate"));
}

TEST_CASE("cones count where the table holds some: a gradient finds the grains that show it, an index their cohesion") {
  Calibration c = shipped_table();
  SoilTest cone, heap;
  cone.meaning.test = StrengthTest::cone;
  // Made up: packings and levels differ by factors, as cones in loose and dense sand do.
  for (SoilResponse& r : c.response)
    r.cone_gradient = 20 * std::pow(1.4, double(r.contact)) * std::pow(3, double(r.packing));
  const double angle = 34, unit_weight = 1600 * kGravity / 1e3;
  cone.cone_gradient = fixed(unit_weight * cone_gradient(c, angle, 1));
  const SoilTest triaxial = envelope(StrengthTest::triaxial, Stage::peak, angle, 0);
  const SoilPosterior alone = soil_posterior(c, state({triaxial})), both = soil_posterior(c, state({triaxial, cone}));
  CHECK(both.left_out.empty());
  CHECK(both.disagreements.empty());
  CHECK(both.packing[1] > alone.packing[1] + 0.2);
  // Ten times as much: no packing of such grains shows it.
  cone.cone_gradient = fixed(30 * unit_weight * cone_gradient(c, angle, 2));
  const SoilPosterior torn = soil_posterior(c, state({triaxial, cone}));
  REQUIRE_FALSE(torn.disagreements.empty());
  CHECK(contains(torn.disagreements[0], "cone: gradient"));
  // Of coarse soil the index is the gradient at mid-depth and what cohesion adds.
  cone.cone_gradient.reset();
  const double depth = (cone.cone_depth.minimum + cone.cone_depth.maximum) / 2, cohesion = 5;
  const double factor = bearing_capacity_factor(angle);
  cone.cone_index =
      fixed(unit_weight * cone_gradient(c, angle, 1) * depth + cohesion * (factor + surcharge_factor(angle)));
  SoilTest loose = triaxial;
  loose.cohesion = range(0, 60);
  CHECK(soil_posterior(c, state({loose, cone}, "sand")).cohesion.mean < 15);
  CHECK(soil_posterior(c, state({loose}, "sand")).cohesion.mean > 25);
  const SoilPosterior none = soil_posterior(without_cones(c), state({triaxial, cone}, "sand"));
  REQUIRE(none.left_out.size() == 1);
  CHECK(contains(none.left_out[0], "--onto"));
}

TEST_CASE("a number that no grains of the table show is said to be beyond it, with what they show") {
  SoilTest cone, heap = envelope(StrengthTest::triaxial, Stage::peak, 20, 10);
  cone.meaning.test = StrengthTest::cone;
  cone.cone_index = fixed(500e3);
  const SoilPosterior p = soil_posterior(shipped_table(), state({heap, cone}, "clay"));
  REQUIRE_FALSE(p.disagreements.empty());
  CHECK(contains(p.disagreements[0], "cone: index [kPa] is 5e+05, which no grains of the table show: theirs is"));
}

TEST_CASE("an unconfined strength and a cone index find the cohesion that shows both, in fine-grained soil alone") {
  const Calibration c = shipped_table();
  const double angle = 25, cohesion = 12;
  SoilTest crushed, cone;
  crushed.meaning.test = StrengthTest::unconfined;
  crushed.unconfined_strength = fixed(cohesion / cohesion_of_unconfined(1, angle));
  cone.meaning.test = StrengthTest::cone;
  cone.cone_index = fixed(cone_index(1e3 * cohesion, angle) / 1e3);
  SoilTest heap;
  heap.meaning.test = StrengthTest::triaxial;
  heap.friction_angle = fixed(angle);
  const SoilPosterior clay = soil_posterior(c, state({heap, crushed, cone}, "clay"));
  CHECK(clay.cohesion.mean == Approx(cohesion).margin(1.5));
  CHECK(clay.disagreements.empty());
  CHECK(clay.left_out.empty());
  const SoilPosterior sand = soil_posterior(without_cones(c), state({heap, crushed, cone}, "sand"));
  REQUIRE(sand.left_out.size() == 1);
  CHECK(contains(sand.left_out[0], "fine-grained"));
}

TEST_CASE("an intercept fitted at 20 to 200 kPa is a small cohesion at a small wheel's stress, and itself inside") {
  const MacroscopicSoil soil{.friction_angle = 35, .cohesion = 2000};
  const Range tested{20e3, 200e3};
  CHECK(at_stress(soil, tested, 100e3).cohesion == 2000);
  const MacroscopicSoil low = at_stress(soil, tested, 5e3), lower = at_stress(soil, tested, 2e3);
  CHECK(low.cohesion < 600);
  CHECK(lower.cohesion < 0.5 * low.cohesion);
  CHECK(low.friction_angle > 35);
  // The tangent touches the power law, which goes on through the tested end.
  const auto strength = [](const MacroscopicSoil& s, double stress) {
    return s.cohesion + stress * std::tan(to_radians(s.friction_angle));
  };
  const double at_end = strength(soil, 20e3), near_end = strength(at_stress(soil, tested, 19.99e3), 19.99e3);
  CHECK(near_end == Approx(at_end).epsilon(1e-3));
  const double h = 1;
  CHECK((strength(at_stress(soil, tested, 5e3 + h), 5e3 + h) - strength(low, 5e3)) / h ==
        Approx(std::tan(to_radians(low.friction_angle))).epsilon(1e-3));
  CHECK(at_stress({.friction_angle = 35, .cohesion = 0}, tested, 2e3).friction_angle == 35);
}

TEST_CASE("cone indices come back from the cohesion that they are made of, and too small ones are refused") {
  for (const double angle : {0.0, 10.0, 25.0})
    for (const double cohesion : {0.0, 3e3, 40e3})
      CHECK(cohesion_of_cone(cone_index(cohesion, angle), angle) == Approx(cohesion).margin(1e-6));
  CHECK(contains(input_error([] { cohesion_of_cone(10e3, 30); }), "give a smaller angle"));
}

}  // namespace gonogo::terrain
