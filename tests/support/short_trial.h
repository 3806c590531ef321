// The demo's trial cut short, for tests of what happens around and inside trials.
#pragma once
#include <filesystem>

#include "pipeline/campaign/trial/trial.h"

namespace gonogo::campaign {

/// A tenth of a second of parking, then at most `time_limit` of driving [s]; the beds are shared by all tests.
inline TrialSetup short_setup(double time_limit) {
  namespace fs = std::filesystem;
  TrialSetup s = read_trial_setup(read_study(fs::path(GONOGO_SOURCE_DIR) / "configs/studies/demo.json"),
                                  fs::temp_directory_path() / "gonogo-test-beds");
  s.bed_length = 1.8;
  s.time_limit = time_limit;
  s.min_drive_time = 0.1;
  s.ramp_time = 0.05;
  s.park_time = 0.1;
  return s;
}

/// Slope along [deg], friction angle [deg], depth of the bed [m].
inline DesignPoint design_point(double slope, double friction_angle, double depth) {
  DesignPoint p;
  p.seed = 5;
  p.variables.assign(contract().variables.size(), 0);
  const auto set = [&](const char* name, double x) { p.variables[contract().variable_index(name)] = x; };
  set("slope_along", slope);
  set("friction_angle", friction_angle);
  set("relative_density", 0.5);
  set("tyre_friction", 0.8);
  set("bed_depth", depth);
  set("commanded_speed", 1.5);
  return p;
}

}  // namespace gonogo::campaign
