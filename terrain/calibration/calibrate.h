// Measures a calibration table by virtual tests.
#pragma once
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// Runs all tests for a grain size; `threads` tests at a time. Deterministic.
Calibration calibrate(double grain_diameter, int threads);

}  // namespace gonogo::terrain
