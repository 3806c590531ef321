// Virtual drained triaxial test in a box of six smooth platens. Grains are compressed equally from all sides, with the
// friction that gives the wanted density. Then their contact laws are switched on. The top platen moves down at
// constant speed while constant forces push the lateral platens. Gravity is off.
#pragma once
#include "terrain/soil_test/line_fit.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

struct TriaxialSettings {
  double confining_stress = 10e3;  // [Pa]
  double inertial_number = 6e-3;   // strain rate times d sqrt(solid density / stress); below 1e-2: quasi-static [-]
  double strain = 0.3;             // of the height at the end; compression is positive [-]
  double steps_per_time = 10;      // in d sqrt(solid density / stress)
  int grains_wide = 9, grains_high = 16;
};

struct TriaxialSample {
  double strain;          // of the height, compression positive
  double axial_stress;    // mean since the last sample [Pa]
  double lateral_stress;  // the same, over both moving lateral platens [Pa]
  double volume_strain;   // dilation positive
};

struct TriaxialResult {
  std::vector<TriaxialSample> curve;
  double peak_axial = 0, peak_lateral = 0;      // mean over 3 % of strain at the largest ratio [Pa]
  double steady_axial = 0, steady_lateral = 0;  // mean over the last third of the strain [Pa]
  double solid_fraction = 0;                    // of the whole box before shear [-]
  double worst_residual = 0;                    // [m/s]
};

TriaxialResult triaxial_test(const TestSoil& soil, const TriaxialSettings& settings, const TestPace& pace,
                             TestScene* scene = nullptr);
Index triaxial_steps(const TriaxialSettings& settings);

/// Mohr-Coulomb line through several tests: s1 = N s3 + 2 c sqrt(N), N = tan^2(45 + phi / 2). Weights are 1 / s1^2,
/// because strengths scatter in proportion to themselves. The line is in (s3, s1), since s3 is set and s1 measured; a
/// line in (s1 + s3) / 2 and (s1 - s3) / 2 has the scatter of s1 in both and is too steep. It goes through the origin
/// without contact cohesion, or with one stress.
struct TriaxialStrength {
  Angle peak_angle, steady_angle;
  double peak_cohesion = 0, peak_cohesion_error = 0;      // [Pa]
  double steady_cohesion = 0, steady_cohesion_error = 0;  // [Pa]
};
TriaxialStrength triaxial_strength(const std::vector<TriaxialResult>& results, bool cohesive);

}  // namespace gonogo::terrain
