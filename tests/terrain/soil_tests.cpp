// Virtual soil tests on coarse, small beds: trends and bounds.
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "terrain/soil_test/penetration.h"
#include "terrain/soil_test/repose.h"
#include "terrain/soil_test/strength_test.h"
#include "terrain/soil_test/test_run.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"

namespace gonogo::terrain {
namespace {

TestSoil coarse_soil(double friction, double rolling, double relative_density) {
  TestSoil soil;
  soil.grain_diameter = 0.09;
  soil.grain = {Real(friction), Real(rolling), 0};
  soil.relative_density = relative_density;
  return soil;
}

/// Coarser than the tests' own numerics, for trends. Not for plates: theirs need the bed to be solved.
TestPace rough_pace() {
  TestPace pace;
  pace.iterations = 60;
  pace.tolerance = 0.05;
  return pace;
}

/// Settled once for all tests that do not care about density.
const Packing& shared_cell() {
  static const Packing cell = test_bed(coarse_soil(0.5, 0, 0.5), 10, 6, 8, 1);
  return cell;
}

ShearResult sheared(const TestSoil& soil, const Packing& cell, double travel, const TestPace& pace = {}) {
  ShearSettings settings;
  settings.travel = travel;
  return shear_test(cell, soil.laws(), settings, pace);
}

}  // namespace

TEST_CASE("without gravity a shear test knows no length but the grain and no stress but the load") {
  // A quarter of the size and four times the stress change every number by a power of two: the ratio keeps its bits.
  const TestSoil soil = coarse_soil(0.5, 0.1, 0.5);
  const Packing& cell = shared_cell();
  Packing small = cell;
  for (double* length : {&small.spec.length, &small.spec.width, &small.spec.depth, &small.spec.grain_diameter})
    *length /= 4;
  for (auto* grains : {&small.grain, &small.base})
    for (Grain& g : *grains) {
      g.position = g.position * 0.25;
      g.radius /= 4;
    }
  small.surface /= 4;
  ShearSettings settings;
  settings.travel = 0.3;
  const ShearResult reference = shear_test(cell, soil.laws(), settings);
  const ShearResult fine = shear_test(small, soil.laws(), settings);
  settings.normal_stress *= 4;
  const ShearResult loaded = shear_test(cell, soil.laws(), settings);
  CHECK(reference.normal_stress == Approx(10e3).epsilon(0.05));
  CHECK(fine.shear_stress == reference.shear_stress);
  CHECK(fine.dilation == reference.dilation);
  CHECK(loaded.shear_stress == 4 * reference.shear_stress);
}

TEST_CASE("a shear test has the same bits for any number of threads") {
  TestPace two;
  two.threads = 2;
  const TestSoil soil = coarse_soil(0.3, 0, 0.5);
  CHECK(sheared(soil, shared_cell(), 0.1).shear_stress == sheared(soil, shared_cell(), 0.1, two).shear_stress);
}

TEST_CASE("tests that step together have the bits of tests that step alone") {
  struct Results {
    ShearResult shear[2];
    CreepResult creep;
    double other_normal = 0;
    int refused = 0;
  };
  const auto run = [](bool together) {
    Results r;
    TestBench bench(sim::Backend::cpu, 2, together);
    TestPace pace = rough_pace();
    pace.bench = &bench;
    bench.run(5, [&](std::size_t k) {
      ShearSettings settings;
      settings.travel = k == 1 ? 0.3 : 0.2;     // the second stays longer than the first in the same batch
      if (k == 2) settings.normal_stress *= 2;  // another step, another batch
      if (k < 2)
        r.shear[k] = shear_test(shared_cell(), coarse_soil(0.3 + 0.2 * double(k), 0, 0.5).laws(), settings, pace);
      if (k == 2)
        r.other_normal = shear_test(shared_cell(), coarse_soil(0.5, 0, 0.5).laws(), settings, pace).normal_stress;
      if (k == 3) r.creep = creep_test(shared_cell(), coarse_soil(0.5, 0, 0.5).laws(), {.time = 0.02}, pace);
      if (k == 4) {
        settings.normal_stress = 0;
        try {
          shear_test(shared_cell(), coarse_soil(0.5, 0, 0.5).laws(), settings, pace);
        } catch (const InputError&) {
          ++r.refused;
        }
      }
    });
    return r;
  };
  const Results alone = run(false), together = run(true);
  for (int k = 0; k < 2; ++k) {
    CHECK(together.shear[k].shear_stress == alone.shear[k].shear_stress);
    CHECK(together.shear[k].worst_residual == alone.shear[k].worst_residual);
  }
  CHECK(together.other_normal == alone.other_normal);
  CHECK(together.creep.way == alone.creep.way);
  CHECK(together.refused == 1);
}

TEST_CASE("side by side on every device a bed carries the load of its test") {
  for (const sim::Backend backend : test::backends()) {
    TestBench bench(backend, 1, true);
    TestPace pace = pace_of(usual_numerics(shared_cell().spec.grain_diameter));
    pace.bench = &bench;
    double normal[3] = {};
    bench.run(3, [&](std::size_t k) {
      ShearSettings settings;
      settings.travel = 0.5;
      settings.normal_stress = k == 2 ? 20e3 : 10e3;
      normal[k] = shear_test(shared_cell(), coarse_soil(0.5, 0.1, 0.5).laws(), settings, pace).normal_stress;
    });
    CHECK(normal[0] == normal[1]);
    CHECK(normal[0] == Approx(10e3).epsilon(0.05));
    CHECK(normal[2] == Approx(20e3).epsilon(0.05));
  }
}

TEST_CASE("a failure of one test ends all that step together") {
  TestBench bench(sim::Backend::cpu, 1, true);
  TestPace pace = rough_pace();
  pace.bench = &bench;
  const auto job = [&](std::size_t k) {
    if (k == 2) throw InputError("no such soil");
    shear_test(shared_cell(), coarse_soil(0.5, 0, 0.5).laws(), {}, pace);
    FAIL("a test went on after another had failed");
  };
  CHECK_THROWS_WITH(bench.run(3, job), "no such soil");
}

TEST_CASE("a dense bed is stronger at its peak than a loose one, and rises when sheared") {
  const TestSoil soft = coarse_soil(0.5, 0, 0), hard = coarse_soil(0.5, 0, 1);
  const ShearResult loose = sheared(soft, test_bed(soft, 10, 6, 8, 1), 0.8);
  const ShearResult dense = sheared(hard, test_bed(hard, 10, 6, 8, 1), 0.8);
  CHECK(dense.peak_stress > 1.05 * loose.peak_stress);
  CHECK(dense.dilation > loose.dilation);
}

TEST_CASE("the triaxial friction angle is within three degrees of that of shear") {
  const TestSoil soil = coarse_soil(0.3, 0, 0);
  TriaxialSettings settings;
  settings.grains_wide = 7;
  settings.grains_high = 12;
  settings.strain = 0.2;
  const TriaxialResult t = triaxial_test(soil, settings, rough_pace());
  const ShearResult s = sheared(soil, shared_cell(), 1.5);
  const double triaxial = triaxial_strength({t}, false).steady_angle.degrees;
  const double shear = to_degrees(std::atan(s.shear_stress / s.normal_stress));
  CAPTURE(triaxial, shear);
  CHECK(std::fabs(triaxial - shear) < 3);
}

/// Pressure that a plate carries at a sinkage, between its samples [Pa].
double pressure_at(const PlateResult& r, double sinkage) {
  std::size_t k = 1;
  while (k + 1 < r.curve.size() && r.curve[k].sinkage < sinkage) ++k;
  const PlateSample &below = r.curve[k - 1], &above = r.curve[k];
  return below.pressure +
         (above.pressure - below.pressure) * (sinkage - below.sinkage) / (above.sinkage - below.sinkage);
}

TEST_CASE("a plate sinks as its load grows and never comes up again, less far into a dense bed") {
  PlateSettings settings;
  settings.width_grains = 3;
  settings.growth_time = 2;
  double carried[2];
  for (int k = 0; k < 2; ++k) {
    const PlateResult r = plate_test(coarse_soil(0.5, 0.1, double(k)), settings, rough_pace());
    for (std::size_t i = 1; i < r.curve.size(); ++i) {
      CHECK(r.curve[i].sinkage > r.curve[i - 1].sinkage - 0.01 * 0.09);
      if (i % 8 == 0) CHECK(r.curve[i].pressure == Approx(1.25 * r.curve[i - 8].pressure));
    }
    CHECK(r.curve.back().sinkage > 0.4 * r.width);
    const PowerLaw law = fit_power_law(r);
    CAPTURE(law.k, law.n, law.r2);
    CHECK(law.n > 0);
    CHECK(law.n < 1.5);
    carried[k] = pressure_at(r, 0.3 * r.width);
  }
  CAPTURE(carried[0], carried[1]);
  CHECK(carried[1] > 1.2 * carried[0]);
}

TEST_CASE("a heap of grains that resist rolling is steeper than one of grains that roll") {
  ReposeSettings settings;
  settings.length = 12;
  settings.width = 5;
  settings.height = 6;
  settings.gate_speed = 0.5;
  const ReposeResult rolls = repose_test(coarse_soil(0.5, 0, 0.5), settings, rough_pace());
  const ReposeResult resists = repose_test(coarse_soil(0.5, 0.3, 0.5), settings, rough_pace());
  CAPTURE(rolls.angle.degrees, resists.angle.degrees);
  CHECK(rolls.angle.degrees > 12);
  CHECK(rolls.angle.degrees < 30);
  CHECK(resists.angle.degrees > rolls.angle.degrees + 2);
  CHECK(rolls.spilled > resists.spilled);
}

TEST_CASE("a dense bed resists the cone more than a loose one") {
  ConeSettings settings;
  settings.diameter_grains = 2;
  settings.depth = 1;
  settings.speed = 0.5;
  const ConeResult loose = cone_test(coarse_soil(0.5, 0, 0), settings, rough_pace());
  const ConeResult dense = cone_test(coarse_soil(0.5, 0, 1), settings, rough_pace());
  CAPTURE(loose.index, dense.index, fit_cone({loose}).slope, fit_cone({dense}).slope);
  CHECK(dense.bulk_density > loose.bulk_density);
  CHECK(dense.index > 1.2 * loose.index);
  CHECK(fit_cone({loose}).slope > 0);
  settings.max_pressure = 1;
  CHECK_THROWS_AS(cone_test(coarse_soil(0.5, 0, 0), settings, rough_pace()), DeviceError);
}

TEST_CASE("the cone's line is that of the mean of its beds, at even depths") {
  ConeResult a, b;
  for (int k = 0; k < 5; ++k) {
    const double z = 0.01 * k, off = k % 2 == 0 ? 500 : -500;
    a.profile.push_back({z, 1e3 + 2e5 * z + off});
    b.profile.push_back({z, 3e3 + 4e5 * z - off});
  }
  const LineFit f = fit_cone({a, b});
  CHECK(f.intercept == Approx(2e3));
  CHECK(f.slope == Approx(3e5));
  CHECK(f.r2 == Approx(1));
  CHECK(fit_cone({a}).r2 < 0.99);
}

TEST_CASE("a pressure in proportion to the depth of what the cone presses shows its gradient, whatever its noise") {
  // A 30 degree cone is 1.866 base diameters high: a third of that lies 0.0622 m below a base of 0.1 m.
  ConeResult clean, noisy;
  clean.diameter = noisy.diameter = 0.1;
  for (int k = 0; k <= 20; ++k) {
    const double z = 0.0075 * k;
    clean.profile.push_back({z, 4e5 * (z + 0.1 / 6 / std::tan(to_radians(15)))});
    noisy.profile.push_back({z, clean.profile.back().pressure + (k % 4 < 2 ? 2e4 : -2e4)});
  }
  CHECK(proportional_gradient(clean) == Approx(4e5));
  CHECK(proportional_gradient(noisy) == Approx(4e5).epsilon(0.03));
}

TEST_CASE("the contacts of a bed at rest carry at every level the weight above it, within five per cent") {
  const GeostaticResult r = geostatic_test(coarse_soil(0.5, 0.1, 0.5), 8, {});
  REQUIRE(r.profile.size() >= 6);
  CAPTURE(r.worst_error);
  CHECK(r.worst_error < 0.05);
  // By the solid fraction too, which nothing above was computed from: half-way between two levels far apart.
  const auto &upper = r.profile[2], &lower = r.profile[5];
  const double gradient = (lower.stress - upper.stress) / (lower.depth - upper.depth);
  CHECK(gradient == Approx(2650 * kGravity * r.solid_fraction).epsilon(0.06));
}

TEST_CASE("a bed of the trials' grains does not creep, and keeps its strength when it is sheared slowly") {
  // With 14 x 2 updates of rigid contacts the plate creeps by a grain a second, and the angle is 15 degrees.
  TestSoil soil;
  soil.grain = {Real(0.625), Real(0.225), 0};
  soil.relative_density = 0.4;
  const Packing cell = test_bed(soil, 10, 6, 8, 1);
  const TestPace pace = pace_of(usual_numerics(soil.grain_diameter));
  const double stress = 10e3;
  const double steps = stress_time(soil.grain_diameter, soil.grain_density, stress) / 1e-3;
  const CreepResult c = creep_test(cell, soil.laws(), {.normal_stress = stress, .steps_per_time = steps}, pace);
  CAPTURE(c.way, c.speed, c.worst_residual);
  CHECK(std::fabs(c.speed) < 0.05);
  const ShearResult slow =
      shear_test(cell, soil.laws(),
                 {.normal_stress = stress, .inertial_number = 1e-3, .travel = 1.2, .steps_per_time = steps}, pace);
  const double angle = std::atan(slow.shear_stress / slow.normal_stress) / kDegree;
  CAPTURE(angle, slow.worst_residual);
  CHECK(angle > 24);
  CHECK(angle < 34);
  CHECK(slow.worst_residual < 5e-3);
}

TEST_CASE("soil tests refuse what cannot be tested") {
  CHECK_THROWS_AS(check(coarse_soil(-0.1, 0, 0.5)), InputError);
  CHECK_THROWS_AS(check(coarse_soil(0.5, 0, 1.1)), InputError);
  CHECK_THROWS_AS(check(coarse_soil(std::nan(""), 0, 0.5)), InputError);
  ShearSettings none;
  none.normal_stress = 0;
  const TestSoil soil = coarse_soil(0.5, 0, 0.5);
  CHECK_THROWS_AS(shear_test(shared_cell(), soil.laws(), none), InputError);
  CHECK_THROWS_AS(creep_test(shared_cell(), soil.laws(), {.normal_stress = 0}), InputError);
  CHECK_THROWS_AS(creep_test(shared_cell(), soil.laws(), {.time = 0}), InputError);
}

}  // namespace gonogo::terrain
