// Virtual tests of shear strength: simple shear and triaxial compression.
#pragma once
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

/// Virtual simple-shear test in a doubly periodic cell. A rough plate of glued grains, loaded from above, moves across
/// a settled packing at constant speed. Gravity is off, so that the stress is the same at every height and the grain is
/// the only length. Several loads give friction angle and cohesion.
struct ShearSettings {
  double normal_stress = 10e3;    // [Pa]
  double inertial_number = 6e-3;  // shear rate times d sqrt(solid density / stress); below 1e-2: quasi-static [-]
  double travel = 4;              // of the plate, in grain diameters
  double steps_per_time = 10;     // in d sqrt(solid density / stress), see stress_time
};

struct ShearSample {
  double travel;         // of the plate, in grain diameters
  double shear_stress;   // mean since the last sample [Pa]
  double normal_stress;  // mean since the last sample [Pa]
  double rise;           // of the plate since the start, in grain diameters
};

struct ShearResult {
  double peak_stress;     // largest shear stress over half a diameter of travel [Pa]
  double shear_stress;    // steady: mean over the second half of the travel [Pa]
  double normal_stress;   // carried by the bed; mean over the same half [Pa]
  double scatter;         // standard error of the steady shear stress [Pa]
  double dilation;        // rise of the plate over the travel, in grain diameters
  double worst_residual;  // largest root-mean-square residual [m/s]
  std::vector<ShearSample> curve;
};

/// A creep test: the plate of the same cell under a constant load along it that is too small to shear the bed steadily.
struct CreepSettings {
  double normal_stress = 10e3;  // [Pa]
  double share = 0.36;          // of the shear stress in the normal stress [-]
  double time = 1;              // under the whole load [s]
  double steps_per_time = 10;   // in d sqrt(solid density / stress)
};

struct CreepResult {
  double way = 0;             // of the plate while the load grew and stayed, in grain diameters
  double speed = 0;           // in the second half of the time, in grain diameters a second
  double worst_residual = 0;  // largest root-mean-square residual [m/s]
};

/// Spec of the cell of shear tests: ten by six grains, eight deep.
BedSpec shear_cell(double grain_diameter, double settle_friction, std::uint64_t seed,
                   GrainShape shape = GrainShape::sphere);

/// Number of steps of a test.
Index shear_steps(const ShearSettings& settings);

ShearResult shear_test(const Packing& cell, const BedLaws& laws, const ShearSettings& settings,
                       const TestPace& pace = {}, TestScene* scene = nullptr);

CreepResult creep_test(const Packing& cell, const BedLaws& laws, const CreepSettings& settings,
                       const TestPace& pace = {});

/// tau = c + sigma tan(phi) through results at several loads. The line goes through the origin if there is one load.
struct ShearStrength {
  Angle peak_angle, steady_angle;
  double peak_cohesion = 0, peak_cohesion_error = 0;      // [Pa]
  double steady_cohesion = 0, steady_cohesion_error = 0;  // [Pa]
  double peak_r2 = 0, steady_r2 = 0;
};
ShearStrength shear_strength(const std::vector<ShearResult>& results);

/// K of tau = tau_max (1 - exp(-j / K)) from samples (j, tau) up to where tau first reaches 95 % of tau_max [m], by
/// Wong's weighted least squares (Journal of Terramechanics 17 (1980) 5-21):
///   K = - sum (1 - t)^2 j^2 / sum (1 - t)^2 j ln(1 - t), t = tau / tau_max,
/// which weighs by what is left to the limit, since the logarithm grows as it is neared. Throws InputError when no
/// sample lies below.
double fit_janosi(const std::vector<double>& displacement, const std::vector<double>& stress, double max_stress);

/// Virtual drained triaxial test in a box of six smooth platens. Grains are compressed equally from all sides, with the
/// friction that gives the wanted density. Then their contact laws are switched on. The top platen moves down at
/// constant speed while constant forces push the lateral platens. Gravity is off.
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
