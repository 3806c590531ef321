#include "terrain/calibration/calibrate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "base/cancel.h"
#include "base/error.h"
#include "base/line.h"
#include "base/progress.h"
#include "terrain/calibration/journal.h"
#include "terrain/soil_test/plate.h"
#include "terrain/soil_test/shear.h"

namespace gonogo::terrain {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// The line of contact parameters: sliding friction first, rolling friction joins where spheres alone saturate. So
/// close that the friction angle rises by less than about 5 degrees from one to the next. Sliding friction above 1.5
/// makes beds burst that are pressed: the cone program lets sliding contacts open, the faster the rougher they are.
struct ContactPoint {
  double friction, rolling_friction;
};
using ContactLine = std::vector<ContactPoint>;

/// Clumps lock with each other: they need no rolling friction.
const ContactLine& contact_line(GrainShape shape) {
  static const ContactLine spheres = {{0.05, 0},   {0.1, 0},   {0.2, 0},   {0.3, 0},    {0.4, 0.05},
                                      {0.5, 0.1},  {0.6, 0.2}, {0.7, 0.3}, {0.8, 0.45}, {0.9, 0.6},
                                      {1.05, 0.9}, {1.2, 1.3}, {1.4, 1.8}};
  static const ContactLine clumps = {{0.05, 0}, {0.1, 0}, {0.15, 0}, {0.2, 0}, {0.25, 0}, {0.3, 0},
                                     {0.4, 0},  {0.5, 0}, {0.6, 0},  {0.7, 0}, {0.8, 0},  {1.0, 0}};
  return shape == GrainShape::sphere ? spheres : clumps;
}
/// Settling friction of the packing library, from loose to dense.
constexpr double kSettleFriction[] = {0.8, 0.25, 0.02};
constexpr double kNormalStress = 10e3;  // [Pa]; without gravity only the ratios below matter
/// Cohesion pressure between grains over normal stress. At three times the stress rough grains move in lumps that slide
/// past each other, and less is carried than at once.
constexpr double kCohesionRatio[] = {0, 0.5, 1};
constexpr double kPlateWidth = 4;  // in grain diameters

enum class Kind { shear, plate };

struct Job {
  Kind kind;
  std::size_t contact, packing, seed, ratio;
  std::string name;
  std::vector<double> result;  // empty where the simulation failed; shear: steady and peak stress ratio, residual,
                               // solid fraction; plate: k, n, residual
};

std::vector<Job> all_jobs(const ContactLine& contacts, int seeds) {
  std::vector<Job> jobs;
  for (std::size_t s = 0; s < std::size_t(seeds); ++s)
    for (std::size_t c = 0; c < contacts.size(); ++c)
      for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) {
        const std::string at = line("friction %g rolling %g settled at %g seed %zu", contacts[c].friction,
                                    contacts[c].rolling_friction, kSettleFriction[p], s + 1);
        for (std::size_t r = 0; r < std::size(kCohesionRatio); ++r)
          jobs.push_back({Kind::shear, c, p, s, r, line("shear %s cohesion %g", at.c_str(), kCohesionRatio[r]), {}});
        jobs.push_back({Kind::plate, c, p, s, 0, "plate " + at, {}});
      }
  return jobs;
}

sim::PairLaw law_of(const CalibrationRun& run, const Job& job) {
  const ContactPoint& point = contact_line(run.shape)[job.contact];
  return {Real(point.friction), Real(point.rolling_friction), Real(kCohesionRatio[job.ratio] * kNormalStress)};
}

TestSoil plate_soil(const CalibrationRun& run, std::size_t packing, std::size_t seed) {
  TestSoil soil;
  soil.grain_diameter = run.grain_diameter, soil.shape = run.shape;
  soil.relative_density = relative_density_of(kSettleFriction[packing]);
  soil.seed = seed;
  return soil;
}

PlateSettings plate_settings(const CalibrationRun& run) {
  PlateSettings settings;
  settings.width_grains = kPlateWidth;
  settings.speed = 0.2;
  settings.steps_per_time = gravity_time(run.grain_diameter) / run.numerics.step;
  return settings;
}

/// Settled packings, one for each kind of test, density and seed: all contact levels share them.
class Beds {
 public:
  Beds(const CalibrationRun& run, const std::vector<Job>& jobs, const std::vector<std::size_t>& open)
      : run_(run), bed_(2 * std::size(kSettleFriction) * std::size_t(run.seeds)) {
    std::vector<std::size_t> needed;
    for (const std::size_t k : open) needed.push_back(place(jobs[k]));
    std::sort(needed.begin(), needed.end());
    needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
    std::reverse(needed.begin(), needed.end());  // plates' beds, which take longest, first
    run_jobs(needed.size(), run.threads, [&](std::size_t i) { settle(needed[i]); });
  }
  const Packing& operator()(const Job& job) const { return bed_[place(job)]; }

 private:
  std::size_t place(const Job& job) const {
    return (std::size_t(job.kind) * std::size(kSettleFriction) + job.packing) * std::size_t(run_.seeds) + job.seed;
  }
  void settle(std::size_t place) {
    stop_if_cancelled();
    const std::size_t seed = place % std::size_t(run_.seeds) + 1, level = place / std::size_t(run_.seeds);
    const std::size_t packing = level % std::size(kSettleFriction);
    if (Kind(level / std::size(kSettleFriction)) == Kind::shear)
      bed_[place] = settle_packing(shear_cell(run_.grain_diameter, kSettleFriction[packing], seed, run_.shape), 1);
    else
      bed_[place] = plate_bed(plate_soil(run_, packing, seed), plate_settings(run_), 1);
  }

  const CalibrationRun& run_;
  std::vector<Packing> bed_;
};

void run_shear(Job& job, const CalibrationRun& run, const Packing& cell) {
  ShearSettings settings;
  settings.normal_stress = kNormalStress, settings.travel = run.travel;
  settings.steps_per_time = stress_time(run.grain_diameter, cell.spec.grain_density, kNormalStress) / run.numerics.step;
  const sim::PairLaw law = law_of(run, job);
  const ShearResult r = shear_test(cell, {law, law}, settings, pace_of(run.numerics));
  job.result = {r.shear_stress / r.normal_stress, r.peak_stress / r.normal_stress, r.worst_residual,
                cell.solid_fraction};
}

void run_plate(Job& job, const CalibrationRun& run, const Packing& bed) {
  TestSoil soil = plate_soil(run, job.packing, job.seed + 1);
  soil.grain = law_of(run, job);
  soil.tool_friction = double(soil.grain.friction);
  const PlateResult r = plate_test(bed, soil, plate_settings(run), pace_of(run.numerics));
  const PowerLaw law = fit_power_law(r);
  job.result = {law.k, law.n, r.worst_residual};
}

void run_all(std::vector<Job>& jobs, const CalibrationRun& run, TestJournal& journal) {
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < jobs.size(); ++k)
    if (const auto known = journal.find(jobs[k].name))
      jobs[k].result = *known;
    else
      open.push_back(k);
  // Plates take longest: first, so that no thread is left with one at the end.
  std::stable_partition(open.begin(), open.end(), [&](std::size_t k) { return jobs[k].kind == Kind::plate; });
  const Beds beds(run, jobs, open);
  Progress progress("soil calibrate", "tests", jobs.size());
  const std::size_t reused = jobs.size() - open.size();
  std::size_t done = reused;
  progress.update(done, "", reused);
  run_jobs(open.size(), run.threads, [&](std::size_t i) {
    Job& job = jobs[open[i]];
    try {
      job.kind == Kind::shear ? run_shear(job, run, beds(job)) : run_plate(job, run, beds(job));
    } catch (const DeviceError&) {
      job.result.clear();  // counted in the table's provenance
    }
    journal.add(job.name, job.result);
#pragma omp critical(calibration_progress)
    progress.update(++done, "", reused);
  });
}

/// Numbers `index` of all results of one kind at a contact level and packing (or all packings) and cohesion ratio.
struct Selection {
  const ContactLine& contacts;
  const std::vector<Job>& jobs;

  std::vector<double> operator()(Kind kind, std::size_t contact, std::ptrdiff_t packing, std::size_t ratio,
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
  std::vector<double> with_gaps(Kind kind, std::size_t contact, std::ptrdiff_t packing, std::size_t ratio,
                                std::size_t index) const {
    std::vector<double> values;
    for (const Job& j : jobs)
      if (j.kind == kind && j.contact == contact && j.ratio == ratio &&
          (packing < 0 || j.packing == std::size_t(packing)))
        values.push_back(j.result.empty() ? std::nan("") : j.result[index]);
    return values;
  }
};

/// Cohesion per contact cohesion pressure: slope, by least squares through the test without, of what cohesion adds to
/// the stress ratio over the cohesion ratio, for each cell; tests of the same cells stand in the same order.
MeanError cohesion_gain(const Selection& of, std::size_t contact, std::ptrdiff_t packing) {
  const auto dry = of.with_gaps(Kind::shear, contact, packing, 0, 0);
  std::vector<double> gain(dry.size());
  double square = 0;
  for (std::size_t r = 1; r < std::size(kCohesionRatio); ++r) square += kCohesionRatio[r] * kCohesionRatio[r];
  for (std::size_t r = 1; r < std::size(kCohesionRatio); ++r) {
    const auto sticky = of.with_gaps(Kind::shear, contact, packing, r, 0);
    for (std::size_t i = 0; i < dry.size(); ++i) gain[i] += kCohesionRatio[r] * (sticky[i] - dry[i]) / square;
  }
  std::erase_if(gain, [](double g) { return std::isnan(g); });
  return mean_error(gain);
}

ContactLevel contact_level(const Selection& of, std::size_t c) {
  const MeanError ratio = mean_error(of(Kind::shear, c, -1, 0, 0)), gain = cohesion_gain(of, c, -1);
  const Angle angle = angle_of_tangent(ratio.mean, ratio.error);
  const ContactPoint& point = of.contacts[c];
  return {point.friction, point.rolling_friction, angle.degrees, angle.error, gain.mean, gain.error};
}

SoilResponse response(const Selection& of, std::size_t c, std::size_t p) {
  const auto packing = std::ptrdiff_t(p);
  const MeanError steady = mean_error(of(Kind::shear, c, packing, 0, 0)),
                  peak = mean_error(of(Kind::shear, c, packing, 0, 1));
  const MeanError gain = cohesion_gain(of, c, packing);
  const MeanError k = mean_error(of(Kind::plate, c, packing, 0, 0)), n = mean_error(of(Kind::plate, c, packing, 0, 1));
  SoilResponse r;
  r.contact = c, r.packing = p;
  r.friction_angle = std::atan(steady.mean) / kDegree, r.peak_friction_angle = std::atan(peak.mean) / kDegree;
  r.cohesion_gain = gain.mean;
  r.sinkage_modulus = k.mean, r.sinkage_modulus_error = k.error, r.sinkage_exponent = n.mean;
  return r;
}

/// Least-squares fit that never falls along the line (pool adjacent violators; Ayer et al. 1955): stronger contacts do
/// not make weaker soil, and where the measured scatter says so, neighbours share their mean.
void make_monotone(std::vector<ContactLevel>& levels) {
  std::vector<std::pair<double, int>> pools;  // mean, count
  for (const ContactLevel& l : levels) {
    pools.emplace_back(l.friction_angle, 1);
    while (pools.size() > 1 && pools[pools.size() - 2].first > pools.back().first) {
      const auto [mean, count] = pools.back();
      pools.pop_back();
      auto& last = pools.back();
      last = {(last.first * last.second + mean * count) / (last.second + count), last.second + count};
    }
  }
  std::size_t k = 0;
  for (const auto& [mean, count] : pools)
    for (int i = 0; i < count; ++i) levels[k++].friction_angle = mean;
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
    weight += w, sum += w * l.cohesion_gain;
  }
  c.cohesion_gain = sum / weight, c.cohesion_gain_error = std::sqrt(1 / weight);
}

/// Levels from the weakest on until more than a third of the same tests fail in a packing: grains so rough burst when
/// they are pressed at this step.
std::size_t usable_levels(const Selection& of) {
  const auto failing = [&](Kind kind, std::size_t contact, std::size_t packing, std::size_t ratio) {
    const auto values = of.with_gaps(kind, contact, std::ptrdiff_t(packing), ratio, 0);
    return 3 * std::count_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }) >
           std::ptrdiff_t(values.size());
  };
  for (std::size_t c = 0; c < of.contacts.size(); ++c)
    for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) {
      if (failing(Kind::plate, c, p, 0)) return c;
      for (std::size_t r = 0; r < std::size(kCohesionRatio); ++r)
        if (failing(Kind::shear, c, p, r)) return c;
    }
  return of.contacts.size();
}

std::vector<PackingLevel> packing_levels(const Selection& of) {
  std::vector<PackingLevel> levels;
  for (std::size_t p = 0; p < std::size(kSettleFriction); ++p)
    levels.push_back({kSettleFriction[p], mean_error(of(Kind::shear, 0, std::ptrdiff_t(p), 0, 3)).mean, 0});
  const double loosest = 1 / levels.front().solid_fraction, densest = 1 / levels.back().solid_fraction;
  for (PackingLevel& l : levels) l.relative_density = (loosest - 1 / l.solid_fraction) / (loosest - densest);
  return levels;
}

Json provenance(const std::vector<Job>& jobs, const CalibrationRun& run, std::size_t levels) {
  double worst = 0;
  std::uint64_t failed = 0;
  for (const Job& j : jobs) j.result.empty() ? void(++failed) : void(worst = std::max(worst, j.result[2]));
  Json p;
  p["test"] =
      "simple shear without gravity of a doubly periodic cell, 10 x 6 grains, 8 deep, "
      "inertial number 0.006; plate 4 grains wide on a bed of 24 x 6 grains, 12 deep, under gravity";
  write_numerics(p, run.numerics);
  p["travel_grain_diameters"] = run.travel;
  p["normal_stress_Pa"] = kNormalStress;
  p["cohesion_pressure_over_normal_stress"] = std::vector<double>(std::begin(kCohesionRatio), std::end(kCohesionRatio));
  p["seeds"] = run.seeds;
  p["failed_tests"] = failed;
  p["contact_levels_left_out"] = std::uint64_t(contact_line(run.shape).size() - levels);
  p["worst_rms_residual_m_per_s"] = worst;
  return p;
}

}  // namespace

std::string journal_maker(const CalibrationRun& run) {
  return line("calibrate/5 %s of %g m, travel %g, %s", name_of(run.shape).c_str(), run.grain_diameter, run.travel,
              description(run.numerics).c_str());
}

std::vector<std::string> calibration_tests(const CalibrationRun& run) {
  std::vector<std::string> names;
  for (const Job& job : all_jobs(contact_line(run.shape), run.seeds)) names.push_back(job.name);
  return names;
}

Calibration calibrate(const CalibrationRun& run) {
  if (!(run.grain_diameter > 0)) throw InputError("soil calibrate: the grain diameter must be above zero");
  TestJournal journal(run.journal, journal_maker(run));
  const ContactLine& contacts = contact_line(run.shape);
  std::vector<Job> jobs = all_jobs(contacts, run.seeds);
  run_all(jobs, run, journal);
  const Selection of{contacts, jobs};
  Calibration c;
  c.grain_diameter = run.grain_diameter, c.shape = run.shape;
  c.packing = packing_levels(of);
  const std::size_t levels = usable_levels(of);
  if (levels < 2) throw DeviceError("soil calibrate: most tests failed; calibrate with a smaller step");
  for (std::size_t k = 0; k < levels; ++k) {
    c.contact.push_back(contact_level(of, k));
    for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) c.response.push_back(response(of, k, p));
  }
  make_monotone(c.contact);
  hold_cohesion(c.contact);
  pool_cohesion(c);
  c.provenance = provenance(jobs, run, levels);
  return c;
}

}  // namespace gonogo::terrain
