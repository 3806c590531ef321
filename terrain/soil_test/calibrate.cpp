#include "terrain/soil_test/calibrate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/json/config.h"
#include "base/json/seal.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "base/units.h"
#include "terrain/soil_test/penetration.h"
#include "terrain/soil_test/strength_test.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

TestJournal::TestJournal(std::filesystem::path path, std::string maker)
    : path_(std::move(path)), maker_(std::move(maker)) {
  if (path_.empty() || !std::filesystem::exists(path_)) return;
  const Config file = Config::read(path_);
  file.choice("schema", {"gonogo/soil_journal/1"});
  if (file.text("maker") != maker_)
    file.fail("maker", "these tests were made by another grain size, shape or version (" + file.text("maker") +
                           "); name another file or remove this one");
  require_seal(file.json(), path_.string(), "remove it, and its tests are run again");
  for (const Config& test : file.objects("tests")) result_[test.text("name")] = test.numbers("numbers");
}

std::optional<std::vector<double>> TestJournal::find(const std::string& test) const {
  const std::lock_guard lock(mutex_);
  const auto found = result_.find(test);
  if (found == result_.end()) return std::nullopt;
  return found->second;
}

void TestJournal::add(const std::string& test, const std::vector<double>& numbers) {
  const std::lock_guard lock(mutex_);
  result_[test] = numbers;
  save();
}

void TestJournal::save() const {
  if (path_.empty()) return;
  Json j;
  j["schema"] = "gonogo/soil_journal/1";
  j["maker"] = maker_;
  j["tests"] = Json::array();
  for (const auto& [name, numbers] : result_) {
    Json test;
    test["name"] = name;
    test["numbers"] = numbers;
    j["tests"].push_back(test);
  }
  write_file_atomically(path_, sealed(std::move(j)).dump(1) + "\n");
}

namespace {

struct ContactPoint {
  double friction, rolling_friction;
};
using ContactLine = std::vector<ContactPoint>;

/// Settling friction of the packing library, from loose to dense.
constexpr double kSettleFriction[] = {0.8, 0.25, 0.02};
constexpr double kConfiningStress = 10e3;  // [Pa]; without gravity only the ratios below matter
/// Cohesion pressure between grains over confining stress. At three times the stress, rough grains move in lumps that
/// slide past each other, and the strength is lower than at one times.
constexpr double kCohesionRatio[] = {0, 0.5, 1};

enum class TestKind { triaxial, shear, plate, cone, loosest };

/// One test. Its result is empty when the simulation failed; otherwise, by kind:
///   triaxial  axial and lateral stress in steady deformation, then at the peak, over the confining stress;
///             max residual [m/s]
///   shear     shear over normal stress on the plane of shear: peak, steady; max residual [m/s]
///   plate     k [N/m^(n+2)] and n of p = k z^n, max residual [m/s], solid fraction of the bed
///   cone      gradient of the index over the bed's unit weight, max residual [m/s]
///   loosest   solid fraction of a bed that settles with its own contact laws
struct CalibrationTest {
  TestKind kind;
  std::size_t contact, packing, seed, ratio;  // indices of levels; ratio: of kCohesionRatio
  ContactPoint grains;                        // of that contact level
  std::string name;
  std::vector<double> result{};
};

/// Whether such grains settle more loosely than the library's loosest packing, because they are rougher than the grains
/// that made it.
bool settles_loosely(const ContactPoint& p) { return p.rolling_friction > 0 || p.friction > kSettleFriction[0]; }

constexpr double kPlateWidth = 4;  // in grain diameters

sim::PairLaw law_of(const CalibrationTest& test) {
  return {Real(test.grains.friction), Real(test.grains.rolling_friction),
          Real(kCohesionRatio[test.ratio] * kConfiningStress)};
}

TestSoil test_soil(const CalibrationRun& run, std::size_t packing, std::size_t seed) {
  TestSoil soil;
  soil.settled_on = run.device;
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

ConeSettings cone_settings(const CalibrationRun& run) {
  ConeSettings settings;
  settings.steps_per_time = gravity_time(run.grain_diameter) / run.numerics.step;
  return settings;
}

/// Beds of these specs: side by side on the CPU, in one batch on a GPU. One that did not come to rest has a solid
/// fraction of 0; on a GPU DeviceError is thrown for it.
std::vector<Packing> settled(const std::vector<BedSpec>& specs, const CalibrationRun& run) {
  if (run.device != sim::Backend::cpu) return settle_packings(specs, 1);
  std::vector<Packing> beds(specs.size());
  const auto settle = [&](std::size_t i) {
    try {
      beds[i] = settle_packing(specs[i], 1);
    } catch (const DeviceError&) {
      beds[i] = {};
    }
  };
  for_each_on_host(specs.size(), 1, settle, run.threads);
  return beds;
}

/// The bed that a test starts from, which tests of the same spec share; none of a triaxial test.
std::optional<BedSpec> bed_spec(const CalibrationTest& t, const CalibrationRun& run) {
  if (t.kind == TestKind::triaxial) return std::nullopt;
  if (t.kind == TestKind::shear) {
    BedSpec cell = shear_cell(run.grain_diameter, kSettleFriction[t.packing], t.seed + 1, run.shape);
    cell.settled_on = run.device;
    return cell;
  }
  if (t.kind == TestKind::cone) return cone_bed_spec(test_soil(run, t.packing, t.seed + 1), cone_settings(run));
  BedSpec bed = plate_bed_spec(test_soil(run, t.packing, t.seed + 1), plate_settings(run));
  if (t.kind == TestKind::loosest) {
    bed.settle_friction = t.grains.friction;
    bed.settle_rolling = t.grains.rolling_friction;
  }
  return bed;
}

using Beds = std::map<std::string, Packing>;  // by BedSpec::hash()

Beds settled_beds(const CalibrationRun& run, const std::vector<CalibrationTest*>& open) {
  std::map<std::string, BedSpec> spec;
  for (const CalibrationTest* t : open)
    if (const auto bed = bed_spec(*t, run)) spec[bed->hash()] = *bed;
  std::vector<BedSpec> specs;
  for (const auto& [hash, bed] : spec) specs.push_back(bed);
  std::vector<Packing> packings = settled(specs, run);
  Beds beds;
  auto next = packings.begin();
  for (const auto& [hash, bed] : spec) beds[hash] = std::move(*next++);
  return beds;
}

const Packing& bed_of(const CalibrationTest& t, const CalibrationRun& run, const Beds& beds) {
  const Packing& bed = beds.at(bed_spec(t, run)->hash());
  if (!(bed.solid_fraction > 0)) throw DeviceError("soil calibrate: a bed did not come to rest");
  return bed;
}

void run_plate(CalibrationTest& test, const CalibrationRun& run, const Packing& bed, const TestPace& pace) {
  TestSoil soil = test_soil(run, test.packing, test.seed + 1);
  soil.grain = law_of(test);
  soil.tool_friction = double(soil.grain.friction);
  const PlateResult r = plate_test(bed, soil, plate_settings(run), pace);
  const PowerLaw law = fit_power_law(r);
  test.result = {law.k, law.n, r.worst_residual, bed.solid_fraction};
}

void run_cone(CalibrationTest& test, const CalibrationRun& run, const Packing& bed, const TestPace& pace) {
  TestSoil soil = test_soil(run, test.packing, test.seed + 1);
  soil.grain = law_of(test);
  soil.tool_friction = double(soil.grain.friction);
  const ConeResult r = cone_test(bed, soil, cone_settings(run), pace);
  test.result = {proportional_gradient(r) / (r.bulk_density * kGravity), r.worst_residual};
}

void run_shear(CalibrationTest& test, const CalibrationRun& run, const Packing& bed, const TestPace& pace) {
  TestSoil soil = test_soil(run, test.packing, test.seed + 1);
  soil.grain = law_of(test);
  ShearSettings settings;
  settings.normal_stress = kConfiningStress;
  settings.steps_per_time = stress_time(run.grain_diameter, soil.grain_density, kConfiningStress) / run.numerics.step;
  const ShearResult r = shear_test(bed, soil.laws(), settings, pace);
  test.result = {r.peak_stress / kConfiningStress, r.shear_stress / r.normal_stress, r.worst_residual};
}

void run_triaxial(CalibrationTest& test, const CalibrationRun& run, const TestPace& pace) {
  TestSoil soil = test_soil(run, test.packing, test.seed + 1);
  soil.grain = law_of(test);
  TriaxialSettings settings;
  settings.confining_stress = kConfiningStress;
  settings.steps_per_time = stress_time(run.grain_diameter, soil.grain_density, kConfiningStress) / run.numerics.step;
  const TriaxialResult r = triaxial_test(soil, settings, pace);
  test.result = {r.steady_axial / kConfiningStress, r.steady_lateral / kConfiningStress,
                 r.peak_axial / kConfiningStress, r.peak_lateral / kConfiningStress, r.worst_residual};
}

void run_test(CalibrationTest& test, const CalibrationRun& run, const Beds& beds, const TestPace& pace) {
  switch (test.kind) {
    case TestKind::plate:
      return run_plate(test, run, bed_of(test, run, beds), pace);
    case TestKind::cone:
      return run_cone(test, run, bed_of(test, run, beds), pace);
    case TestKind::shear:
      return run_shear(test, run, bed_of(test, run, beds), pace);
    case TestKind::loosest:
      test.result = {bed_of(test, run, beds).solid_fraction};
      return;
    case TestKind::triaxial:
      return run_triaxial(test, run, pace);
  }
}

/// Fills in the results: from the journal, or by running the test.
void run_tests(std::vector<CalibrationTest>& tests, const CalibrationRun& run) {
  TestJournal journal(run.journal, journal_maker(run));
  std::vector<CalibrationTest*> open;
  for (CalibrationTest& t : tests)
    if (const auto known = journal.find(t.name))
      t.result = *known;
    else
      open.push_back(&t);
  // Plates take longest: first, so that no thread is left with one at the end.
  std::stable_partition(open.begin(), open.end(), [](const auto* t) { return t->kind == TestKind::plate; });
  const Beds beds = settled_beds(run, open);
  Progress progress("soil calibrate", "tests", tests.size());
  const std::size_t reused = tests.size() - open.size();
  std::size_t done = reused;
  progress.update(done, "", reused);
  std::mutex mutex;
  TestBench bench(run.device, run.threads);
  TestPace pace = pace_of(run.numerics);
  pace.bench = &bench;
  bench.run(open.size(), [&](std::size_t i) {
    CalibrationTest& test = *open[i];
    try {
      run_test(test, run, beds, pace);
    } catch (const DeviceError& e) {
      log_line("soil calibrate", test.name + ": " + e.what());
      test.result.clear();  // counted in the table's provenance
    }
    journal.add(test.name, test.result);
    const std::lock_guard lock(mutex);
    progress.update(++done, "", reused);
  });
}

}  // namespace

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

namespace {

/// All tests of a run, seed by seed, without results.
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
        add(TestKind::shear, p, 0, "shear " + at);
        if (!for_angle_only) add(TestKind::plate, p, 0, "plate " + at);
      }
      if (!for_angle_only && settles_loosely(contacts[c]))
        add(TestKind::loosest, 0, 0, line("loosest %s seed %zu", grains.c_str(), s + 1));
    }
  }
  return tests;
}

/// Numbers `index` of all results of one kind at a contact level and packing (or all packings) and cohesion ratio.
struct Selection {
  const ContactLine& contacts;
  const std::vector<CalibrationTest>& tests;

  std::vector<double> operator()(TestKind kind, std::size_t contact, std::ptrdiff_t packing, std::size_t ratio,
                                 std::size_t index) const {
    const std::vector<double> values = with_gaps(kind, contact, packing, ratio, index);
    std::vector<double> known;
    std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](double v) { return !std::isnan(v); });
    if (known.empty())
      throw DeviceError(line("soil calibrate: every test at friction %g failed; calibrate with a smaller step",
                             contacts[contact].friction));
    return known;
  }

  /// The same with NaN where a simulation failed, so that tests of the same cells keep their places.
  std::vector<double> with_gaps(TestKind kind, std::size_t contact, std::ptrdiff_t packing, std::size_t ratio,
                                std::size_t index) const {
    std::vector<double> values;
    for (const CalibrationTest& j : tests)
      if (j.kind == kind && j.contact == contact && j.ratio == ratio &&
          (packing < 0 || j.packing == std::size_t(packing)))
        values.push_back(j.result.empty() ? std::nan("") : j.result[index]);
    return values;
  }
};

/// Numbers of a triaxial test's result.
constexpr std::size_t kSteady = 0, kPeak = 2, kTriaxialResidual = 4;

/// Sines of friction angles, (s1 - s3) / (s1 + s3), without cohesion; `of_what`: kSteady or kPeak.
std::vector<double> sines(const Selection& of, std::size_t contact, std::ptrdiff_t packing, std::size_t of_what) {
  const auto axial = of.with_gaps(TestKind::triaxial, contact, packing, 0, of_what);
  const auto lateral = of.with_gaps(TestKind::triaxial, contact, packing, 0, of_what + 1);
  std::vector<double> sine;
  for (std::size_t i = 0; i < axial.size(); ++i) sine.push_back((axial[i] - lateral[i]) / (axial[i] + lateral[i]));
  return sine;
}

/// Mean friction angle of the tests that did not fail.
Angle friction_angle(const Selection& of, std::size_t contact, std::ptrdiff_t packing, std::size_t of_what) {
  std::vector<double> sine = sines(of, contact, packing, of_what);
  std::erase_if(sine, [](double x) { return std::isnan(x); });
  const MeanError mean = mean_error(sine);
  return angle_of_sine(mean.mean, mean.error);
}

/// Mean angle on the plane of shear; `index`: 0 peak, 1 steady.
Angle shear_angle(const Selection& of, std::size_t contact, std::size_t packing, std::size_t index) {
  const MeanError mean = mean_error(of(TestKind::shear, contact, std::ptrdiff_t(packing), 0, index));
  return angle_of_tangent(mean.mean, mean.error);
}

/// Cohesion per contact cohesion pressure: slope, by least squares through the origin over the cohesion ratios, of the
/// cohesion at the peak, s1 - s3 = (s1 + s3) sin(phi) + 2 c cos(phi), phi that of the same specimen without; specimens
/// stand in the same order in all tests.
MeanError cohesion_gain(const Selection& of, std::size_t contact, std::ptrdiff_t packing) {
  const std::vector<double> sine = sines(of, contact, packing, kPeak);
  // More specimens may have been tested without cohesion, after those that were tested with it too.
  std::vector<double> gain(of.with_gaps(TestKind::triaxial, contact, packing, 1, kPeak).size());
  double square = 0;
  for (std::size_t r = 1; r < std::size(kCohesionRatio); ++r) square += kCohesionRatio[r] * kCohesionRatio[r];
  for (std::size_t r = 1; r < std::size(kCohesionRatio); ++r) {
    const auto axial = of.with_gaps(TestKind::triaxial, contact, packing, r, kPeak);
    const auto lateral = of.with_gaps(TestKind::triaxial, contact, packing, r, kPeak + 1);
    for (std::size_t i = 0; i < gain.size(); ++i) {
      const double cohesion =
          (axial[i] - lateral[i] - (axial[i] + lateral[i]) * sine[i]) / (2 * std::sqrt(1 - sine[i] * sine[i]));
      gain[i] += kCohesionRatio[r] * cohesion / square;
    }
  }
  std::erase_if(gain, [](double g) { return std::isnan(g); });
  return mean_error(gain);
}

SoilResponse response(const Selection& of, std::size_t c, std::size_t p) {
  const auto packing = std::ptrdiff_t(p);
  const Angle peak = friction_angle(of, c, packing, kPeak);
  const MeanError k = mean_error(of(TestKind::plate, c, packing, 0, 0)),
                  n = mean_error(of(TestKind::plate, c, packing, 0, 1));
  SoilResponse r;
  r.contact = c;
  r.packing = p;
  r.friction_angle = peak.degrees;
  r.friction_angle_error = peak.error;
  r.steady_friction_angle = friction_angle(of, c, packing, kSteady).degrees;
  r.shear_peak = shear_angle(of, c, p, 0);
  r.shear_steady = shear_angle(of, c, p, 1);
  r.cohesion_gain = cohesion_gain(of, c, packing).mean;
  r.sinkage_modulus = k.mean;
  r.sinkage_modulus_error = k.error;
  r.sinkage_exponent = n.mean;
  return r;
}

/// Solid fraction of the loosest bed that grains of a contact level make: settled with their own laws, where that is
/// looser than the library's loosest packing.
double loosest_solid_fraction(const Selection& of, std::size_t c, double library) {
  if (!settles_loosely(of.contacts[c])) return library;
  return std::min(library, mean_error(of(TestKind::loosest, c, 0, 0, 0)).mean);
}

/// What does not depend on the packing, and the mean friction angle and its error over those.
ContactLevel contact_level(const Selection& of, std::size_t c, const Calibration& table) {
  const std::vector<SoilResponse>& responses = table.response;
  const MeanError gain = cohesion_gain(of, c, -1);
  ContactLevel level{.friction = of.contacts[c].friction,
                     .rolling_friction = of.contacts[c].rolling_friction,
                     .cohesion_gain = gain.mean,
                     .cohesion_gain_error = gain.error};
  level.loosest_solid_fraction = loosest_solid_fraction(of, c, table.packing.front().solid_fraction);
  const double packings = double(std::size(kSettleFriction));
  for (const SoilResponse& r : responses)
    if (r.contact == c) {
      level.friction_angle += r.friction_angle / packings;
      level.friction_angle_error += r.friction_angle_error / packings;
    }
  return level;
}

/// Least-squares fit of a packing's friction angles that never falls along the line (pool adjacent violators; Ayer et
/// al. 1955): stronger contacts do not make weaker soil, and where the measured scatter says so, neighbours share their
/// mean.
void make_monotone(std::vector<SoilResponse>& responses, std::size_t packing) {
  std::vector<std::pair<double, int>> pools;  // mean, count
  for (const SoilResponse& r : responses) {
    if (r.packing != packing) continue;
    pools.emplace_back(r.friction_angle, 1);
    while (pools.size() > 1 && pools[pools.size() - 2].first > pools.back().first) {
      const auto [mean, count] = pools.back();
      pools.pop_back();
      auto& last = pools.back();
      last = {(last.first * last.second + mean * count) / (last.second + count), last.second + count};
    }
  }
  std::size_t k = 0;
  for (const auto& [mean, count] : pools)
    for (int i = 0; i < count; ++i) responses[k++ * std::size(kSettleFriction) + packing].friction_angle = mean;
}

/// Rough grains with cohesion shear in lumps, and some cells carry less with cohesion than without. Where a level's
/// gain is therefore not known to a fifth, that of the last level where it was holds on, with the deviation in its
/// error: trials get a cohesion in proportion, fits refuse it.
void hold_cohesion(std::vector<ContactLevel>& levels) {
  constexpr double kKnown = 0.2;
  const ContactLevel* known = nullptr;
  for (ContactLevel& l : levels) {
    if (l.cohesion_gain_error <= kKnown * l.cohesion_gain) {
      known = &l;
    } else if (known) {
      l.cohesion_gain_error += std::fabs(l.cohesion_gain - known->cohesion_gain);
      l.cohesion_gain = known->cohesion_gain;
    }
  }
}

/// One cohesion gain for the whole line, weighted by the inverse squares of the errors: for readers that know no other.
void pool_cohesion(Calibration& c) {
  double weight = 0, sum = 0;
  for (const ContactLevel& l : c.contact) {
    const double w = 1 / std::max(1e-12, l.cohesion_gain_error * l.cohesion_gain_error);
    weight += w;
    sum += w * l.cohesion_gain;
  }
  c.cohesion_gain = sum / weight;
  c.cohesion_gain_error = std::sqrt(1 / weight);
}

/// Levels from the weakest on until more than a third of the same tests fail in a packing: grains so rough burst when
/// they are pressed at this step.
std::size_t usable_levels(const Selection& of) {
  const auto failing = [&](TestKind kind, std::size_t contact, std::size_t packing, std::size_t ratio) {
    const auto values = of.with_gaps(kind, contact, std::ptrdiff_t(packing), ratio, 0);
    return 3 * std::count_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }) >
           std::ptrdiff_t(values.size());
  };
  for (std::size_t c = 0; c < of.contacts.size(); ++c)
    for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) {
      if (failing(TestKind::plate, c, p, 0) || failing(TestKind::shear, c, p, 0)) return c;
      for (std::size_t r = 0; r < std::size(kCohesionRatio); ++r)
        if (failing(TestKind::triaxial, c, p, r)) return c;
    }
  return of.contacts.size();
}

std::vector<PackingLevel> packing_levels(const Selection& of) {
  std::vector<PackingLevel> levels;
  for (std::size_t p = 0; p < std::size(kSettleFriction); ++p)
    levels.push_back({kSettleFriction[p], mean_error(of(TestKind::plate, 0, std::ptrdiff_t(p), 0, 3)).mean, 0});
  const double loosest = 1 / levels.front().solid_fraction, densest = 1 / levels.back().solid_fraction;
  for (PackingLevel& l : levels) l.relative_density = (loosest - 1 / l.solid_fraction) / (loosest - densest);
  return levels;
}

Json provenance(const std::vector<CalibrationTest>& tests, const CalibrationRun& run, std::size_t left_out) {
  double worst = 0;
  std::uint64_t failed = 0;
  for (const CalibrationTest& t : tests) {
    if (t.result.empty())
      ++failed;
    else if (t.kind != TestKind::loosest)
      worst = std::max(worst, t.result[t.kind == TestKind::triaxial ? kTriaxialResidual : 2]);
  }
  Json p;
  p["test"] =
      "triaxial compression without gravity of 9 x 9 x 16 grains between smooth platens, inertial number 0.006; simple "
      "shear without gravity of 10 x 6 grains, 8 deep, at the same; plate 4 grains wide on a bed of 24 x 6 grains, 12 "
      "deep, under gravity; such beds settled with each level's own laws";
  write_numerics(p, run.numerics);
  if (run.device != sim::Backend::cpu) p["device"] = "cuda";
  p["confining_stress_Pa"] = kConfiningStress;
  p["cohesion_pressure_over_confining_stress"] =
      std::vector<double>(std::begin(kCohesionRatio), std::end(kCohesionRatio));
  p["seeds"] = run.seeds;
  p["angle_seeds"] = std::max(run.seeds, run.angle_seeds);
  p["failed_tests"] = failed;
  p["contact_levels_left_out"] = std::uint64_t(left_out);
  p["worst_rms_residual_m_per_s"] = worst;
  return p;
}

}  // namespace

std::string journal_maker(const CalibrationRun& run) {
  return line("calibrate/10 %s of %g m, %s%s", name_of(run.shape).c_str(), run.grain_diameter,
              description(run.numerics).c_str(), run.device == sim::Backend::cpu ? "" : ", on cuda");
}

std::vector<std::string> calibration_tests(const CalibrationRun& run) {
  std::vector<std::string> names;
  for (const CalibrationTest& test : all_tests(run)) names.push_back(test.name);
  return names;
}

Calibration calibrate(const CalibrationRun& run) {
  if (!(run.grain_diameter > 0)) throw InputError("soil calibrate: the grain diameter must be above zero");
  const ContactLine contacts = contact_line(run);
  std::vector<CalibrationTest> tests = all_tests(run);
  run_tests(tests, run);
  const Selection of{contacts, tests};
  Calibration c;
  c.grain_diameter = run.grain_diameter;
  c.shape = run.shape;
  c.packing = packing_levels(of);
  const std::size_t levels = usable_levels(of);
  if (levels < 2) throw DeviceError("soil calibrate: most tests failed; calibrate with a smaller step");
  for (std::size_t k = 0; k < levels; ++k)
    for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) c.response.push_back(response(of, k, p));
  for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) make_monotone(c.response, p);
  for (std::size_t k = 0; k < levels; ++k) c.contact.push_back(contact_level(of, k, c));
  hold_cohesion(c.contact);
  pool_cohesion(c);
  c.provenance = provenance(tests, run, contacts.size() - levels);
  return c;
}

namespace {

/// Cones of all levels and packings of a table, without results, seed by seed.
std::vector<CalibrationTest> cone_tests(const Calibration& table, const CalibrationRun& run) {
  std::vector<CalibrationTest> tests;
  for (std::size_t s = 0; s < std::size_t(run.seeds); ++s)
    for (const SoilResponse& r : table.response) {
      const ContactLevel& l = table.contact[r.contact];
      tests.push_back({.kind = TestKind::cone,
                       .contact = r.contact,
                       .packing = r.packing,
                       .seed = s,
                       .ratio = 0,
                       .grains = {l.friction, l.rolling_friction},
                       .name = line("cone friction %g rolling %g settled at %g seed %zu", l.friction,
                                    l.rolling_friction, kSettleFriction[r.packing], s + 1)});
    }
  return tests;
}

}  // namespace

void add_cones(Calibration& table, const CalibrationRun& run) {
  if (table.response.empty() || !(table.response.front().shear_peak.degrees > 0))
    throw InputError(
        "soil calibrate: the table has no angles on the plane of shear (its version is below 6), and cones "
        "go with them; calibrate again without --onto");
  if (table.packing.size() != std::size(kSettleFriction))
    throw InputError(
        line("soil calibrate: the table has %zu packings where cones are pressed into %zu; calibrate again "
             "without --onto",
             table.packing.size(), std::size(kSettleFriction)));
  std::vector<CalibrationTest> tests = cone_tests(table, run);
  run_tests(tests, run);
  const std::size_t levels = table.response.size();
  std::uint64_t failed = 0;
  for (std::size_t k = 0; k < levels; ++k) {
    std::vector<double> known;
    for (std::size_t t = k; t < tests.size(); t += levels)
      if (!tests[t].result.empty()) known.push_back(tests[t].result[0]);
    failed += std::uint64_t(run.seeds) - known.size();
    if (3 * known.size() < 2 * std::size_t(run.seeds)) continue;
    const MeanError mean = mean_error(known);
    table.response[k].cone_gradient = mean.mean;
    table.response[k].cone_gradient_error = mean.error;
  }
  table.provenance["cone_seeds"] = run.seeds;
  table.provenance["failed_cones"] = failed;
  table.provenance["cone"] = line(
      "30 degree cone 4 grains wide, pushed at %g sqrt(g d) to 1.5 diameters into a bed of 18 x 18 grains, 18 deep; "
      "pressure over the depth of the base and a third of the cone's height",
      ConeSettings{}.speed);
}

}  // namespace gonogo::terrain
