#include "pipeline/lab/validate/simulant.h"

#include "base/error.h"
#include "base/nearest.h"
#include "base/shipped.h"
#include "pipeline/campaign/trial/lanes.h"
#include "terrain/soil/soil_file.h"

namespace gonogo::lab {
namespace {

double or_else(double asked, double usual) { return asked > 0 ? asked : usual; }

}  // namespace

terrain::MacroscopicSoil simulant_soil(const std::string& file, const std::string& state) {
  const std::filesystem::path path = shipped_file("soils", "soil", file);
  const terrain::SoilFile soil = terrain::read_soil(path);
  std::vector<std::string> names;
  for (const terrain::SoilState& s : soil.states) {
    if (state.empty() || s.name == state) return s.macroscopic();
    names.push_back(s.name);
  }
  throw InputError(path.string() + ": no state \"" + state + "\"; it has: " + join_words(names));
}

Rim rim_of(const campaign::TrialSetup& s) {
  if (!s.whole) return {s.rig.radius, s.rig.lug_height};
  return {s.whole->wheel.front().radius, s.whole->wheel.front().lug_height};
}

campaign::TrialSetup simulant_setup(const SimulantRun& run, const terrain::MacroscopicSoil& soil) {
  campaign::TrialSetup s = campaign::vehicle_trial_setup(shipped_file("vehicles", "vehicle", run.vehicle),
                                                         run.calibration, campaign::default_task(), run.numerics);
  if (run.grain > 0) s.calibration.grain_diameter = run.grain;
  s.settled_on = run.gpu ? sim::Backend::cuda : sim::Backend::cpu;
  s.tiles_along = s.tiles_across = 1;
  s.moving_patch = true;
  s.bed_width = 0.7;
  if (s.whole) campaign::fold_bed(s);
  s.bed_length = or_else(run.length, s.whole ? 3.5 : 2);
  s.bed_width = or_else(run.width, s.bed_width);
  s.grain_density = fit_soil(s.calibration, soil).grain_density;
  s.packing_seeds = run.seeds;
  s.test_distance = 1e3;
  s.min_drive_time = s.time_limit = or_else(run.time, s.whole ? 24 : 8);
  s.run_in_distance = 0;
  s.thresholds.immobile_speed = 0;
  s.thresholds.slid_back_share = 10;
  // So slow a wheel does little work: pushing settled grains apart by a hair is much beside it.
  s.thresholds.energy_error = 10;
  if (s.folded) campaign::check_lanes(s);
  terrain::check_patch(s.patch(), s.calibration.grain_diameter);
  return s;
}

std::vector<double> simulant_variables(const SimulantRun& run, const campaign::TrialSetup& setup,
                                       const terrain::MacroscopicSoil& soil, double slope) {
  const double speed = kSimulantWheelSpeed * rim_of(setup).radius;
  std::vector<double> values = plain_variables(setup, slope, soil.friction_angle, speed);
  const auto set = [&](const char* name, double value) { values[campaign::contract().variable_index(name)] = value; };
  set("relative_density", soil.relative_density);
  set("tyre_friction", run.wheel_friction);
  set("bed_depth", run.depth);
  return values;
}

std::vector<campaign::TrialRecord> run_simulant(const SimulantRun& run, const campaign::TrialSetup& setup,
                                                const std::vector<campaign::DesignPoint>& points,
                                                const std::vector<campaign::TrialWatch>& watch) {
  const int places = run.gpu ? int(points.size()) : run.threads;
  return run_trials(setup, points, {run.gpu ? sim::Backend::cuda : sim::Backend::cpu, places, run.threads}, watch);
}

}  // namespace gonogo::lab
