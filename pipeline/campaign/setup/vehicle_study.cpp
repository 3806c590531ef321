#include "pipeline/campaign/setup/vehicle_study.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/parallel/for_each.h"
#include "base/units.h"
#include "pipeline/campaign/setup/read_setup.h"
#include "sim/simulation/simulation.h"
#include "terrain/soil/calibration.h"
#include "vehicle/model/statics.h"

namespace gonogo::campaign {
namespace {

constexpr const char* kTables[] = {"calibration_90mm", "calibration_32mm", "calibration_10mm"};  // coarsest first

/// Time for one update of one grain [s]: quarter wheels on 90 mm grains on a core of an AMD EPYC, and whole HMMWVs on
/// 32 mm grains on an H200 (6.3 s for 50,700 grains in 4,850 steps of 40 updates).
constexpr double kOnCore = 2.6e-7, kOnGpu = 6.4e-10;
constexpr double kMeanDrive = 0.62;  // over the time limit, of 400 HMMWVs with this least drive
constexpr double kSolid = 0.6;       // fraction of a bed's volume

Json range(double low, double high) { return Json::Array{std::stod(line("%.3g", low)), std::stod(line("%.3g", high))}; }

Json drive_section(double time, double diameter) {
  const auto in_s = [&](double units) { return std::stod(line("%.3g", units * time)); };
  const auto in_m = [&](double units) { return std::stod(line("%.3g", units * diameter)); };
  return Json::Object{{"park_s", in_s(1.3)},          {"ramp_s", in_s(1.6)},          {"run_in_m", in_m(1.1)},
                      {"test_distance_m", in_m(2.4)}, {"minimum_drive_s", in_s(6.5)}, {"time_limit_s", in_s(16.2)}};
}

Json design_section(const vehicle::Vehicle& v, double diameter, double mass, double unit_speed, std::size_t points,
                    const terrain::AngleRange& angles) {
  double top = 0;
  for (const vehicle::GearSpeed& g : vehicle::gear_speeds(v)) top = std::max(top, g.balanced);
  const double fast = std::min(unit_speed, 0.9 * top);
  Json ranges = Json::object();
  ranges["slope_along"] = range(-25, 35);
  ranges["slope_across"] = range(-25, 25);
  ranges["friction_angle"] =
      range(std::max(16.0, std::ceil(angles.lowest)), std::min(45.0, std::floor(angles.highest)));
  ranges["cohesion"] = range(0, 15);
  ranges["relative_density"] = range(0, 1);
  ranges["payload"] = range(0, mass / 4);
  ranges["tyre_friction"] = range(0.3, 1);
  ranges["bed_depth"] = range(std::max(0.05, 0.13 * diameter), std::max(0.06, 0.29 * diameter));
  ranges["commanded_speed"] = range(std::max(0.05, 0.4 * fast), std::max(0.06, fast));
  return Json::Object{
      {"method", "sobol"}, {"points", std::uint64_t(points)}, {"replicate_every", 10}, {"ranges", ranges}};
}

/// Grains across a tread that suffice for a study: three quarters of the scale rule's. The next finer table multiplies
/// the cost of a trial by the cube of the grains' ratio and more.
constexpr double kGrainsOfStudy = 0.75 * kGrainsPerTyre;

}  // namespace

std::filesystem::path coarsest_table(double tread, double grains) {
  std::filesystem::path table;
  for (const char* name : kTables) {
    table = shipped_file("soils", "calibration", name);
    if (tread >= grains * terrain::read_calibration(table).grain_diameter) break;
  }
  return table;
}

VehicleStudy study_of_vehicle(const std::filesystem::path& vehicle_file, std::size_t points, double gravity) {
  const vehicle::Vehicle v = vehicle::read_vehicle(vehicle_file);
  const vehicle::Wheel& wheel = v.wheel.front();
  const double diameter = 2 * wheel.radius, time = std::sqrt(diameter / gravity), tread = vehicle::tread_width(v);
  const std::filesystem::path table = coarsest_table(tread, kGrainsOfStudy);
  const terrain::Calibration calibration = terrain::read_calibration(table);
  VehicleStudy s;
  s.grain = calibration.grain_diameter;
  s.grains_per_tread = tread / s.grain;
  Json& j = s.json = Json::object();
  j["study"] = v.name;
  j["about"] = "Trials of " + v.name + " on grains of " + number_text(1e3 * s.grain) + " mm, " +
               number_text(s.grains_per_tread, 2) + " across a tread.";
  j["seed"] = 1;
  if (gravity != kGravity) j["gravity"] = gravity;
  j["vehicle"] = std::filesystem::absolute(vehicle_file).string();
  j["soil"] = Json::Object{{"calibration", std::filesystem::absolute(table).string()}};
  Json& trial = j["trial"] = Json::object();
  const double deepest = std::max(0.06, 0.29 * diameter);
  trial["bed"] =
      Json::Object{{"moving_patch", true}, {"packing_seeds", 3}, {"deepest_m", std::stod(line("%.3g", deepest))}};
  if (wheel.compliant.stiffness > 0) trial["compliant_tyres"] = true;
  trial["wheel_rolling"] = 1;
  trial["drive"] = drive_section(time, diameter);
  const vehicle::Weights w = vehicle::weigh(v);
  j["design"] = design_section(v, diameter, w.total, std::sqrt(gravity * diameter), points,
                               terrain::reachable_angles(calibration));
  const TrialSetup setup = read_trial_setup(read_study(Config::parse(j.dump(), v.name + " study")));
  const double volume = setup.tiles_along * setup.bed_length * setup.tiles_across * setup.bed_width * 0.21 * diameter;
  s.grains = kSolid * volume / (kPi / 6 * std::pow(s.grain, 3));
  const double seconds = setup.bed_settle_time + setup.park_time + kMeanDrive * setup.time_limit;
  s.updates = seconds / setup.numerics.step * setup.numerics.substeps * setup.numerics.iterations;
  return s;
}

StudyCost cost_of(const VehicleStudy& study, std::size_t trials) {
  const double updates = double(trials) * study.grains * study.updates;
  const std::vector<std::string> gpus = sim::cuda_device_names();
  if (!gpus.empty())
    return {updates * kOnGpu / double(gpus.size()), std::to_string(gpus.size()) + " GPUs (" + gpus.front() + ")"};
  const int cores = threads_or_all(0);
  return {updates * kOnCore / cores, std::to_string(cores) + (cores == 1 ? " core" : " cores")};
}

std::string cost_text(const VehicleStudy& study, std::size_t trials) {
  const StudyCost cost = cost_of(study, trials);
  const double hours = cost.seconds / 3600;
  const std::string time =
      hours < 48 ? number_text(std::max(hours, 0.01), 2) + " hours" : number_text(hours / 24, 2) + " days";
  return std::to_string(trials) + " trials: about " + time + " on the " + cost.device + " here";
}

}  // namespace gonogo::campaign
