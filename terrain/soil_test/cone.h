// Virtual cone penetrometer: a 30 degree cone with a thinner shaft is pushed into a bed. Cone index is force over base
// area, as in ASAE S313. The cone scales with the grains, because the standard cone (20.27 mm) is smaller than one
// grain.
//
// The drive moves at constant speed and pushes through a spring, like a proving ring. Without the spring, rigid grains
// jam under the cone and burst away under meaningless forces. With a prescribed load, the cone punches through when
// they do. Pressures differ between beds, because few grains touch the cone. The mean of eight beds is about linear in
// depth.
#pragma once
#include "terrain/soil_test/line_fit.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

struct ConeSettings {
  double diameter_grains = 4;  // of the cone's base, in grain diameters
  double depth = 1.5;          // of the base below the surface at the end, in cone diameters
  double speed = 0.1;          // of the drive, in sqrt(g d)
  double ring = 100;           // stiffness of the spring over base area, in unit weights of the bed
  double max_pressure = 3e7;   // the test stops at this pressure [Pa]
  double steps_per_time = 50;  // in sqrt(d / g)
};

struct ConeSample {
  double depth;     // of the cone's base below the surface; negative while the tip enters [m]
  double pressure;  // force over base area, mean since the last sample [Pa]
};

struct ConeResult {
  double diameter = 0;  // [m]
  std::vector<ConeSample> curve;
  std::vector<ConeSample> profile;              // the curve, interpolated at even depths from the surface to the end
  double index = 0;                             // mean pressure over that range [Pa]
  double bulk_density = 0, worst_residual = 0;  // [kg/m^3], [m/s]
};

ConeResult cone_test(const TestSoil& soil, const ConeSettings& settings, const TestPace& pace,
                     TestScene* scene = nullptr);
Index cone_steps(const ConeSettings& settings);

/// Mean of the profiles of equal tests on several beds.
std::vector<ConeSample> mean_profile(const std::vector<ConeResult>& tests);

/// Line through the mean profile. Its slope is the cone index gradient [Pa/m]; errors come from the scatter about it.
LineFit fit_cone(const std::vector<ConeResult>& tests);

/// The cone and its shaft as a closed mesh, with the base's centre at the origin and the tip down [m].
sim::TriangleMesh cone_mesh(double diameter, double shaft_length);

}  // namespace gonogo::terrain
