// Measures a calibration table by virtual tests: triaxial compression without and with contact cohesion, plate sinkage,
// and how loosely grains settle, over a line of contact parameters and the packings of the library.
#pragma once
#include <utility>

#include "terrain/bed/numerics.h"
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

struct CalibrationRun {
  double grain_diameter = 0.032;  // of the sphere with a grain's volume [m]
  GrainShape shape = GrainShape::sphere;
  int threads = 1;  // tests at a time
  int seeds = 3;    // packings of each density
  /// Packings of each density whose friction angle is measured: that of one rough specimen is off by two degrees from
  /// that of the next, while cohesion and plates need fewer. No less than `seeds`.
  int angle_seeds = 3;
  /// Only contact levels whose sliding friction lies in this range: a table for soils of a narrow range of angles, or
  /// for numerics that are too dear for all. No fewer than two levels.
  std::pair<double, double> friction_range{0, 10};
  Numerics numerics;  // of the trials that the table is for: contacts solved less well make another soil
  /// Finished tests are kept in this file, and a run that finds it goes on from there; empty: nothing is kept.
  std::filesystem::path journal;
};

/// What the journal of such a run calls its maker.
std::string journal_maker(const CalibrationRun& run);
/// Names of the tests of a run, as the journal has them.
std::vector<std::string> calibration_tests(const CalibrationRun& run);

/// Runs what the journal lacks. Deterministic: the same table for any number of threads and interruptions. Throws
/// Cancelled on Ctrl-C, InputError for a journal of another run.
Calibration calibrate(const CalibrationRun& run);

}  // namespace gonogo::terrain
