#include "pipeline/trial/trial.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <set>

#include "base/cancel.h"
#include "base/error.h"
#include "base/progress.h"
#include "pipeline/trial/drive.h"
#include "pipeline/trial/saved_run.h"

namespace gonogo::pipeline {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double value(const DesignPoint& point, const char* name) { return point.variables.at(contract().variable_index(name)); }

terrain::BedSpec spec_of(const TrialSetup& setup, const DesignPoint& point) {
  return setup.bed_spec(value(point, "bed_depth"), value(point, "relative_density"), point.seed);
}

TrialConditions conditions_of(const TrialSetup& setup, const DesignPoint& point) {
  TrialConditions c;
  const Vec3d g = bed_gravity(value(point, "slope_along"), value(point, "slope_across"));
  c.gravity = static_cast<Vec3>(g);
  const sim::PairLaw grain =
      terrain::contact_law(setup.calibration, {value(point, "friction_angle"), value(point, "cohesion") * 1e3});
  // The tyre touches grains with its own friction; soil cohesion and rolling resistance act between grains alone.
  c.laws = {grain, {Real(value(point, "tyre_friction")), 0, 0}};
  c.payload = value(point, "payload");
  c.speed = value(point, "commanded_speed");
  return c;
}

void store_measures(const DriveOutcome& o, TrialRecord& record) {
  const auto set = [&](const char* name, double x) { record.measures[contract().measure_index(name)] = x; };
  set("distance", o.distance);
  set("drive_time", o.drive_time);
  set("mean_speed", o.mean_speed);
  set("slip", o.slip);
  set("sinkage", o.sinkage);
  set("drift", o.drift);
  set("mean_torque", o.mean_torque);
  set("energy_per_metre", o.energy_per_metre);
  set("bed_creep", o.bed_creep);
  set("worst_residual", o.worst_residual);
  set("energy_error", o.energy_error);
}

/// Whether the simulation may be believed: flags, residual and energy.
bool is_valid(const TrialSetup& setup, const DriveOutcome& o) {
  return o.flags == 0 && o.worst_residual <= setup.thresholds.residual &&
         o.energy_error <= setup.thresholds.energy_error;
}

}  // namespace

Vec3d bed_gravity(double slope_along_deg, double slope_across_deg) {
  // The ground plane rises by tan(along) per metre forward and tan(across) per metre left; its normal is z of the bed.
  const double a = std::tan(slope_along_deg * kDegree), b = std::tan(slope_across_deg * kDegree);
  const double n = std::sqrt(1 + a * a + b * b);
  // With s the slope and psi the heading from the fall line, a = tan s cos psi and b = tan s sin psi: this is
  // -g (sin s cos psi, sin s sin psi, cos s).
  return Vec3d{a, b, 1} * (-9.81 / n);
}

void prepare_trials(const TrialSetup& setup, std::span<const DesignPoint> points, int threads) {
  std::vector<terrain::BedSpec> missing;
  std::set<std::string> known;
  for (const DesignPoint& point : points) {
    const terrain::BedSpec spec = spec_of(setup, point);
    if (known.insert(spec.hash()).second && !std::filesystem::exists(terrain::packing_path(spec, setup.packing_folder)))
      missing.push_back(spec);
  }
  if (missing.empty()) return;
  Progress progress("beds", "packings", missing.size());
  std::size_t done = 0;
  std::string failure;
  std::mutex one_at_a_time;  // writing may throw, and an exception must not leave an OpenMP critical region
#pragma omp parallel for schedule(dynamic) num_threads(std::max(1, threads))
  for (std::size_t k = 0; k < missing.size(); ++k) {
    if (cancel_requested()) continue;
    try {
      const terrain::Packing packing = terrain::settle_packing(missing[k], 1);
      const std::lock_guard lock(one_at_a_time);
      terrain::write_packing(terrain::packing_path(missing[k], setup.packing_folder), packing);
      progress.update(++done);
    } catch (const std::exception& e) {
      const std::lock_guard lock(one_at_a_time);
      failure = e.what();
    }
  }
  stop_if_cancelled();
  if (!failure.empty()) throw DeviceError(failure);
}

TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point) {
  return run_trial(setup, point, TrialWatch{});
}

TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch,
                      const TrialCheckpoint& checkpoint) {
  TrialRecord record;
  record.point = point;
  record.measures.assign(contract().measures.size(), std::numeric_limits<double>::quiet_NaN());
  const TrialConditions conditions = conditions_of(setup, point);
  const terrain::Packing packing =
      terrain::shifted(terrain::cached_packing(spec_of(setup, point), setup.packing_folder, 1), point.seed);
  for (record.attempts = saved_attempt(checkpoint);; ++record.attempts) {
    if (watch.start) watch.start();
    const DriveOutcome outcome = drive(setup, packing, conditions, record.attempts, watch, checkpoint);
    if (!checkpoint.path.empty()) std::filesystem::remove(checkpoint.path);  // this attempt is over
    store_measures(outcome, record);
    if (is_valid(setup, outcome)) {
      record.verdict = outcome.verdict;
      record.reason = outcome.reason;
      return record;
    }
    if (record.attempts == 2) return record;  // unknown / simulation_failed
  }
}

}  // namespace gonogo::pipeline
