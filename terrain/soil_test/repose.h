// Virtual angle of repose. A bed stands between two walls on a rough base. One wall is lowered slowly, grains spill
// over it into a pit, and the remaining slope is measured. Plane strain: the bed is periodic across.
#pragma once
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

struct ReposeSettings {
  double length = 24, width = 6, height = 12;  // of the bed, in grain diameters
  double gate_speed = 0.2;                     // in sqrt(g d)
  double steps_per_time = 50;                  // in sqrt(d / g)
};

struct ReposeSample {
  double x;       // from the far wall [m]
  double height;  // of the surface, mean over the width [m]
};

struct ReposeResult {
  Angle angle;                        // of the slope; the error is that of the line fit
  std::vector<ReposeSample> profile;  // at rest, one per grain diameter
  double r2 = 0;
  double spilled = 0;         // share of the grains
  double rest_speed = 0;      // root-mean-square grain speed at the measurement [m/s]
  double worst_residual = 0;  // [m/s]
};

ReposeResult repose_test(const TestSoil& soil, const ReposeSettings& settings, const TestPace& pace,
                         TestScene* scene = nullptr);
/// Estimated number of steps; the bed may take longer to come to rest.
Index repose_steps(const ReposeSettings& settings);

}  // namespace gonogo::terrain
