// Virtual cone penetrometer: a 30 degree cone with a thinner shaft is pushed into a bed at constant speed. The cone's
// size follows the grains, because a standard cone (20.27 mm, ASAE S313) is smaller than one of them; cone index is
// force over base area, as there.
#pragma once
#include "terrain/soil_test/line_fit.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

struct ConeSettings {
  double diameter_grains = 4;  // of the cone's base, in grain diameters
  double depth = 1.5;          // of the base below the surface at the end, in cone diameters
  double speed = 0.1;          // in sqrt(g d)
  double steps_per_time = 50;  // in sqrt(d / g)
};

struct ConeSample {
  double depth;     // of the cone's base below the surface; negative while the tip goes in [m]
  double pressure;  // force over base area, mean since the sample before [Pa]
};

struct ConeResult {
  double diameter = 0;  // [m]
  std::vector<ConeSample> curve;
  double index = 0;                         // mean pressure from the surface to the end [Pa]
  double gradient = 0, gradient_error = 0;  // of pressure over depth, same range [Pa/m]
  double r2 = 0;
  double bulk_density = 0, worst_residual = 0;  // [kg/m^3], [m/s]
};

ConeResult cone_test(const TestSoil& soil, const ConeSettings& settings, const TestPace& pace,
                     TestScene* scene = nullptr);
Index cone_steps(const ConeSettings& settings);

/// The cone and its shaft as a closed mesh, its base at the origin and its tip down [m]. Also for tests.
sim::TriangleMesh cone_mesh(double diameter, double shaft_length);

}  // namespace gonogo::terrain
