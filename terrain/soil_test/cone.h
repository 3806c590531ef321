// Virtual cone penetrometer: a 30 degree cone with a thinner shaft is pushed into a bed. The cone's size follows the
// grains, because a standard cone (20.27 mm, ASAE S313) is smaller than one of them; cone index is force over base
// area, as there.
//
// The drive moves at constant speed and pushes through a spring, as through a proving ring: rigid grains that jam
// before a cone which never gives way burst away under forces that have no meaning, and a load that is given punches
// through once they do. Between beds pressures differ by what single grains do; the mean of eight is about linear in
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
  double max_pressure = 3e7;   // at which the test gives up [Pa]
  double steps_per_time = 50;  // in sqrt(d / g)
};

struct ConeSample {
  double depth;     // of the cone's base below the surface; negative while the tip goes in [m]
  double pressure;  // force over base area, mean since the sample before [Pa]
};

struct ConeResult {
  double diameter = 0;  // [m]
  std::vector<ConeSample> curve;
  std::vector<ConeSample> profile;  // at even depths from the surface to the end, between those of the curve
  double index = 0;                 // mean pressure over that range [Pa]
  double bulk_density = 0, worst_residual = 0;  // [kg/m^3], [m/s]
};

ConeResult cone_test(const TestSoil& soil, const ConeSettings& settings, const TestPace& pace,
                     TestScene* scene = nullptr);
Index cone_steps(const ConeSettings& settings);

/// Mean of the profiles of tests alike on several beds.
std::vector<ConeSample> mean_profile(const std::vector<ConeResult>& tests);

/// Line through it: the slope is the cone index gradient [Pa/m]. Errors are those of its scatter about the line.
LineFit fit_cone(const std::vector<ConeResult>& tests);

/// The cone and its shaft as a closed mesh, its base at the origin and its tip down [m]. Also for tests.
sim::TriangleMesh cone_mesh(double diameter, double shaft_length);

}  // namespace gonogo::terrain
