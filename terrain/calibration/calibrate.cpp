#include "terrain/calibration/calibrate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/cancel.h"
#include "base/error.h"
#include "base/progress.h"
#include "terrain/soil_test/shear.h"

namespace gonogo::terrain {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// The line of contact parameters: sliding friction first, rolling friction joins where spheres alone saturate.
struct ContactPoint {
  double friction, rolling_friction;
};
constexpr ContactPoint kContactLine[] = {{0.1, 0}, {0.3, 0}, {0.5, 0.05}, {0.7, 0.3}, {0.9, 1.5}, {1.5, 3}, {3, 6}};
/// Settling friction of the packing library, from loose to dense.
constexpr double kSettleFriction[] = {0.8, 0.25, 0.02};
constexpr double kNormalStress[] = {5e3, 15e3, 40e3};  // [Pa]
constexpr double kCohesionPressure = 10e3;             // between grains, of the cohesive tests [Pa]
constexpr std::uint64_t kSeeds[] = {1, 2};

double angle_deg(double ratio) { return std::atan(ratio) / kDegree; }

struct Job {
  std::size_t contact, packing, seed, stress;
  bool cohesive;
  ShearResult result;
};

std::vector<Job> all_jobs() {
  std::vector<Job> jobs;
  for (std::size_t c = 0; c < std::size(kContactLine); ++c)
    for (std::size_t p = 0; p < std::size(kSettleFriction); ++p)
      for (std::size_t s = 0; s < std::size(kSeeds); ++s)
        for (std::size_t n = 0; n < std::size(kNormalStress); ++n) {
          jobs.push_back({c, p, s, n, false, {}});
          jobs.push_back({c, p, s, n, true, {}});
        }
  return jobs;
}

/// Friction angle from the ratio of shear to normal stress in the tests without cohesion.
void friction_of(const std::vector<Job>& jobs, std::size_t c, ContactLevel& level) {
  std::vector<double> ratio;
  for (const Job& j : jobs)
    if (j.contact == c && !j.cohesive) ratio.push_back(j.result.shear_stress / j.result.normal_stress);
  const MeanError r = mean_error(ratio);
  level.friction_angle = angle_deg(r.mean);
  level.friction_angle_error = angle_deg(r.mean + r.error) - angle_deg(r.mean);
}

/// Cohesion: the shear stress that contact cohesion adds at equal normal stress.
void cohesion_of(const std::vector<Job>& jobs, std::size_t c, ContactLevel& level) {
  std::vector<double> gain;
  // Tests come in pairs: without and with cohesion, everything else equal (all_jobs).
  for (std::size_t k = 0; k + 1 < jobs.size(); k += 2) {
    const ShearResult &dry = jobs[k].result, &sticky = jobs[k + 1].result;
    if (jobs[k].contact == c)
      gain.push_back((sticky.shear_stress - dry.shear_stress / dry.normal_stress * sticky.normal_stress) /
                     kCohesionPressure);
  }
  const MeanError g = mean_error(gain);
  level.cohesion_gain = g.mean;
  level.cohesion_gain_error = g.error;
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

/// One cohesion gain for the whole line, weighted by the inverse squares of the errors: the levels agree within them.
void pool_cohesion(Calibration& c) {
  double weight = 0, sum = 0;
  for (const ContactLevel& l : c.contact) {
    const double w = 1 / (l.cohesion_gain_error * l.cohesion_gain_error);
    weight += w;
    sum += w * l.cohesion_gain;
  }
  c.cohesion_gain = sum / weight;
  c.cohesion_gain_error = std::sqrt(1 / weight);
}

std::vector<PackingLevel> packing_levels(const std::vector<Packing>& cells) {
  std::vector<PackingLevel> levels;
  for (std::size_t p = 0; p < std::size(kSettleFriction); ++p) {
    double fraction = 0;
    for (std::size_t s = 0; s < std::size(kSeeds); ++s)
      fraction += cells[p * std::size(kSeeds) + s].solid_fraction / double(std::size(kSeeds));
    levels.push_back({kSettleFriction[p], fraction, 0});
  }
  const double loosest = 1 / levels.front().solid_fraction, densest = 1 / levels.back().solid_fraction;
  for (PackingLevel& l : levels) l.relative_density = (loosest - 1 / l.solid_fraction) / (loosest - densest);
  return levels;
}

}  // namespace

Calibration calibrate(double grain_diameter, int threads) {
  std::vector<Packing> cells;
  Progress settling("soil", "packings", std::size(kSettleFriction) * std::size(kSeeds));
  for (const double friction : kSettleFriction)
    for (const std::uint64_t seed : kSeeds) {
      cells.push_back(settle_packing(shear_cell(grain_diameter, friction, seed), 1));
      settling.update(cells.size());
    }
  settling.finish();

  std::vector<Job> jobs = all_jobs();
  Progress progress("soil", "shear tests", jobs.size());
  std::size_t done = 0;
  std::string failure;
#pragma omp parallel for schedule(dynamic) num_threads(std::max(1, threads))
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    if (cancel_requested() || !failure.empty()) continue;
    Job& j = jobs[k];
    const ContactPoint& point = kContactLine[j.contact];
    const sim::PairLaw law{Real(point.friction), Real(point.rolling_friction),
                           Real(j.cohesive ? kCohesionPressure : 0)};
    ShearSettings settings;
    settings.normal_stress = kNormalStress[j.stress];
    try {
      j.result = shear_test(cells[j.packing * std::size(kSeeds) + j.seed], {law, law}, settings);
    } catch (const std::exception& e) {
#pragma omp critical
      failure = e.what();
    }
#pragma omp critical
    progress.update(++done);
  }
  stop_if_cancelled();
  if (!failure.empty()) throw DeviceError(failure);

  Calibration c;
  c.grain_diameter = grain_diameter;
  c.packing = packing_levels(cells);
  for (std::size_t k = 0; k < std::size(kContactLine); ++k) {
    ContactLevel level{kContactLine[k].friction, kContactLine[k].rolling_friction, 0, 0, 0, 0};
    friction_of(jobs, k, level);
    cohesion_of(jobs, k, level);
    c.contact.push_back(level);
  }
  make_monotone(c.contact);
  pool_cohesion(c);
  double worst = 0;
  for (const Job& j : jobs) worst = std::max(worst, j.result.worst_residual);
  c.provenance["test"] = "simple shear of a doubly periodic cell, 10 x 6 grains, 8 deep, 4 diameters of travel";
  c.provenance["normal_stress_Pa"] = std::vector<double>(std::begin(kNormalStress), std::end(kNormalStress));
  c.provenance["cohesion_pressure_Pa"] = kCohesionPressure;
  c.provenance["seeds"] = int(std::size(kSeeds));
  c.provenance["worst_rms_residual_m_per_s"] = worst;
  return c;
}

}  // namespace gonogo::terrain
