#include "terrain/calibration/tests.h"

#include <algorithm>
#include <iterator>

#include "base/cancel.h"
#include "base/error.h"
#include "base/line.h"
#include "base/progress.h"
#include "terrain/calibration/journal.h"
#include "terrain/soil_test/plate.h"
#include "terrain/soil_test/triaxial.h"

namespace gonogo::terrain {
namespace {

constexpr double kPlateWidth = 4;  // in grain diameters

sim::PairLaw law_of(const CalibrationTest& test) {
  return {Real(test.grains.friction), Real(test.grains.rolling_friction),
          Real(kCohesionRatio[test.ratio] * kConfiningStress)};
}

TestSoil test_soil(const CalibrationRun& run, std::size_t packing, std::size_t seed) {
  TestSoil soil;
  soil.grain_diameter = run.grain_diameter;
  soil.shape = run.shape;
  soil.relative_density = relative_density_of(kSettleFriction[packing]);
  soil.seed = seed;
  return soil;
}

PlateSettings plate_settings(const CalibrationRun& run) {
  PlateSettings settings;
  settings.width_grains = kPlateWidth;
  settings.growth_time = 3;
  settings.steps_per_time = gravity_time(run.grain_diameter) / run.numerics.step;
  return settings;
}

/// Settled beds for plates, one for each density and seed: all contact levels share them.
class Beds {
 public:
  Beds(const CalibrationRun& run, const std::vector<CalibrationTest>& tests, const std::vector<std::size_t>& open)
      : run_(run), bed_(std::size(kSettleFriction) * std::size_t(run.seeds)) {
    std::vector<std::size_t> needed;
    for (const std::size_t k : open)
      if (tests[k].kind == TestKind::plate) needed.push_back(place(tests[k]));
    std::sort(needed.begin(), needed.end());
    needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
    run_jobs(needed.size(), run.threads, [&](std::size_t i) {
      stop_if_cancelled();
      const std::size_t packing = needed[i] / std::size_t(run.seeds), seed = needed[i] % std::size_t(run.seeds) + 1;
      bed_[needed[i]] = plate_bed(test_soil(run, packing, seed), plate_settings(run), 1);
    });
  }
  const Packing& operator()(const CalibrationTest& test) const { return bed_[place(test)]; }

 private:
  std::size_t place(const CalibrationTest& test) const { return test.packing * std::size_t(run_.seeds) + test.seed; }

  const CalibrationRun& run_;
  std::vector<Packing> bed_;
};

void run_plate(CalibrationTest& test, const CalibrationRun& run, const Packing& bed) {
  TestSoil soil = test_soil(run, test.packing, test.seed + 1);
  soil.grain = law_of(test);
  soil.tool_friction = double(soil.grain.friction);
  const PlateResult r = plate_test(bed, soil, plate_settings(run), pace_of(run.numerics));
  const PowerLaw law = fit_power_law(r);
  test.result = {law.k, law.n, r.worst_residual, bed.solid_fraction};
}

void run_loosest(CalibrationTest& test, const CalibrationRun& run) {
  BedSpec bed = plate_bed_spec(test_soil(run, 0, test.seed + 1), plate_settings(run));
  bed.settle_friction = test.grains.friction;
  bed.settle_rolling = test.grains.rolling_friction;
  test.result = {settle_packing(bed, 1).solid_fraction};
}

void run_triaxial(CalibrationTest& test, const CalibrationRun& run) {
  TestSoil soil = test_soil(run, test.packing, test.seed + 1);
  soil.grain = law_of(test);
  TriaxialSettings settings;
  settings.confining_stress = kConfiningStress;
  settings.steps_per_time = stress_time(run.grain_diameter, soil.grain_density, kConfiningStress) / run.numerics.step;
  const TriaxialResult r = triaxial_test(soil, settings, pace_of(run.numerics));
  test.result = {r.steady_axial / kConfiningStress, r.steady_lateral / kConfiningStress,
                 r.peak_axial / kConfiningStress, r.peak_lateral / kConfiningStress, r.worst_residual};
}

void run_test(CalibrationTest& test, const CalibrationRun& run, const Beds& beds) {
  switch (test.kind) {
    case TestKind::plate:
      return run_plate(test, run, beds(test));
    case TestKind::loosest:
      return run_loosest(test, run);
    case TestKind::triaxial:
      return run_triaxial(test, run);
  }
}

}  // namespace

void run_tests(std::vector<CalibrationTest>& tests, const CalibrationRun& run) {
  TestJournal journal(run.journal, journal_maker(run));
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < tests.size(); ++k)
    if (const auto known = journal.find(tests[k].name))
      tests[k].result = *known;
    else
      open.push_back(k);
  // Plates and beds take longest: first, so that no thread is left with one at the end.
  std::stable_partition(open.begin(), open.end(), [&](std::size_t k) { return tests[k].kind != TestKind::triaxial; });
  const Beds beds(run, tests, open);
  Progress progress("soil calibrate", "tests", tests.size());
  const std::size_t reused = tests.size() - open.size();
  std::size_t done = reused;
  progress.update(done, "", reused);
  run_jobs(open.size(), run.threads, [&](std::size_t i) {
    CalibrationTest& test = tests[open[i]];
    try {
      run_test(test, run, beds);
    } catch (const DeviceError&) {
      test.result.clear();  // counted in the table's provenance
    }
    journal.add(test.name, test.result);
#pragma omp critical(calibration_progress)
    progress.update(++done, "", reused);
  });
}

const ContactLine& contact_line(GrainShape shape) {
  static const ContactLine spheres = {{0.05, 0},  {0.1, 0},   {0.2, 0},    {0.3, 0},   {0.4, 0.05}, {0.5, 0.1},
                                      {0.6, 0.2}, {0.7, 0.3}, {0.8, 0.45}, {0.9, 0.6}, {1.05, 0.9}};
  // Clumps lock with each other: they need no rolling friction.
  static const ContactLine clumps = {{0.05, 0}, {0.1, 0}, {0.15, 0}, {0.2, 0}, {0.25, 0}, {0.3, 0},
                                     {0.4, 0},  {0.5, 0}, {0.6, 0},  {0.7, 0}, {0.8, 0},  {1.0, 0}};
  return shape == GrainShape::sphere ? spheres : clumps;
}

ContactLine contact_line(const CalibrationRun& run) {
  const auto [min_friction, max_friction] = run.friction_range;
  ContactLine levels;
  for (const ContactPoint& p : contact_line(run.shape))
    if (p.friction >= min_friction && p.friction <= max_friction) levels.push_back(p);
  if (levels.size() < 2)
    throw InputError(
        line("soil calibrate: a sliding friction from %g to %g leaves %zu contact levels, a table needs two; "
             "take a wider range",
             min_friction, max_friction, levels.size()));
  return levels;
}

std::vector<CalibrationTest> all_tests(const CalibrationRun& run) {
  const ContactLine contacts = contact_line(run);
  std::vector<CalibrationTest> tests;
  for (std::size_t s = 0; s < std::size_t(std::max(run.seeds, run.angle_seeds)); ++s) {
    const bool for_angle_only = s >= std::size_t(run.seeds);
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const std::string grains = line("friction %g rolling %g", contacts[c].friction, contacts[c].rolling_friction);
      const auto add = [&](TestKind kind, std::size_t p, std::size_t r, std::string name) {
        tests.push_back({.kind = kind,
                         .contact = c,
                         .packing = p,
                         .seed = s,
                         .ratio = r,
                         .grains = contacts[c],
                         .name = std::move(name)});
      };
      for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) {
        const std::string at = line("%s settled at %g seed %zu", grains.c_str(), kSettleFriction[p], s + 1);
        for (std::size_t r = 0; r < (for_angle_only ? 1 : std::size(kCohesionRatio)); ++r)
          add(TestKind::triaxial, p, r, "triaxial " + at + line(" cohesion %g", kCohesionRatio[r]));
        if (!for_angle_only) add(TestKind::plate, p, 0, "plate " + at);
      }
      if (!for_angle_only && settles_loosely(contacts[c]))
        add(TestKind::loosest, 0, 0, line("loosest %s seed %zu", grains.c_str(), s + 1));
    }
  }
  return tests;
}

}  // namespace gonogo::terrain
