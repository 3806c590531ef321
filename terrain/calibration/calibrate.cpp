#include "terrain/calibration/calibrate.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/error.h"
#include "base/line.h"
#include "terrain/calibration/tests.h"
#include "terrain/soil_test/line_fit.h"

namespace gonogo::terrain {
namespace {

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

/// Those of the tests that did not fail, as an angle.
Angle friction_angle(const Selection& of, std::size_t contact, std::ptrdiff_t packing, std::size_t of_what) {
  std::vector<double> sine = sines(of, contact, packing, of_what);
  std::erase_if(sine, [](double x) { return std::isnan(x); });
  const MeanError mean = mean_error(sine);
  return angle_of_sine(mean.mean, mean.error);
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
      if (failing(TestKind::plate, c, p, 0)) return c;
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
      "triaxial compression without gravity of 9 x 9 x 16 grains between smooth platens, inertial number 0.006; plate "
      "4 grains wide on a bed of 24 x 6 grains, 12 deep, under gravity; such beds settled with each level's own laws";
  write_numerics(p, run.numerics);
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
  return line("calibrate/7 %s of %g m, %s", name_of(run.shape).c_str(), run.grain_diameter,
              description(run.numerics).c_str());
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

}  // namespace gonogo::terrain
