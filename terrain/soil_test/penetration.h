// Virtual tests that push a tool into a bed: plate sinkage and cone penetrometer.
#pragma once
#include "terrain/soil/calibration.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

/// Virtual plate sinkage test: a plate as long as the periodic bed is wide is pressed into it by a growing load. Two
/// plate widths b give Bekker's p = (k_c / b + k_phi) z^n (Bekker, Introduction to Terrain-Vehicle Systems, 1969).
///
/// The load is prescribed, as in a bevameter. At a prescribed speed, rigid grains jam under the plate and burst away,
/// and the pressure jumps between zero and several times its mean. The load grows exponentially, so that samples are
/// evenly spaced in ln p on every soil.
struct PlateSettings {
  double width_grains = 6;                  // of the plate, in grain diameters
  double sinkage = 0.5;                     // at the end of the test, in plate widths
  double growth_time = 6;                   // time in which the load grows by a quarter, in sqrt(d / g)
  double max_pressure = kMaxPlatePressure;  // the test ends here if the sinkage is not reached [Pa]
  double bed_depth = 3;                     // in plate widths; at least 8 grains
  double datum = 1e3;                       // pressure at zero sinkage [Pa]
  double steps_per_time = 50;               // in sqrt(d / g)
};

struct PlateSample {
  double sinkage;   // [m]
  double pressure;  // load plus weight of the plate, over its area [Pa]
};

struct PlateResult {
  double width = 0;  // of the plate [m]
  std::vector<PlateSample> curve;
  double solid_fraction = 0, worst_residual = 0;
};

/// The bed for a plate of these settings: its spec, and the settled packing.
BedSpec plate_bed_spec(const TestSoil& soil, const PlateSettings& settings);
Packing plate_bed(const TestSoil& soil, const PlateSettings& settings, int threads);

PlateResult plate_test(const Packing& bed, const TestSoil& soil, const PlateSettings& settings, const TestPace& pace,
                       TestScene* scene = nullptr);
inline PlateResult plate_test(const TestSoil& soil, const PlateSettings& settings, const TestPace& pace,
                              TestScene* scene = nullptr) {
  return plate_test(plate_bed(soil, settings, pace.threads), soil, settings, pace, scene);
}
Index plate_steps(const PlateSettings& settings);

/// p = k z^n of one plate. Weights p^2 make it a fit of pressures, not of their logarithms (Wong, Journal of
/// Terramechanics 17 (1980) 5-21). k in [N/m^(n+2)]; k_error is relative.
struct PowerLaw {
  double k = 0, n = 0, k_error = 0, n_error = 0, r2 = 0;
};
/// Throws DeviceError where the plate broke into the bed and fewer than three samples remain, as fit_bekker does.
PowerLaw fit_power_law(const PlateResult& plate);

/// Bekker's parameters from several plates with a common exponent.
struct BekkerFit {
  double k_c = 0, k_phi = 0, n = 0;  // [N/m^(n+1)], [N/m^(n+2)], [-]
  double k_c_error = 0, k_phi_error = 0, n_error = 0;
  double r2 = 0;  // of ln p
};
BekkerFit fit_bekker(const std::vector<PlateResult>& plates);

/// Virtual cone penetrometer: a 30 degree cone with a thinner shaft is pushed into a bed. Cone index is force over base
/// area, as in ASAE S313. The cone scales with the grains, because the standard cone (20.27 mm) is smaller than one
/// grain.
///
/// The drive moves at constant speed and pushes through a spring, like a proving ring. Without the spring, rigid grains
/// jam under the cone and burst away under meaningless forces. With a prescribed load, the cone punches through when
/// they do. Pressures differ between beds, because few grains touch the cone. The mean of eight beds is about linear in
/// depth.
struct ConeSettings {
  double diameter_grains = 4;  // of the cone's base, in grain diameters
  double depth = 1.5;          // of the base below the surface at the end, in cone diameters
  double speed = 0.15;         // of the drive, in sqrt(g d)
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

/// The bed for a cone of these settings.
BedSpec cone_bed_spec(const TestSoil& soil, const ConeSettings& settings);

ConeResult cone_test(const Packing& bed, const TestSoil& soil, const ConeSettings& settings, const TestPace& pace,
                     TestScene* scene = nullptr);
inline ConeResult cone_test(const TestSoil& soil, const ConeSettings& settings, const TestPace& pace,
                            TestScene* scene = nullptr) {
  return cone_test(test_bed(soil, cone_bed_spec(soil, settings), pace.threads), soil, settings, pace, scene);
}
Index cone_steps(const ConeSettings& settings);

/// Mean of the profiles of equal tests on several beds.
std::vector<ConeSample> mean_profile(const std::vector<ConeResult>& tests);

/// Line through the mean profile. Its slope is the cone index gradient [Pa/m]; errors come from the scatter about it.
LineFit fit_cone(const std::vector<ConeResult>& tests);

/// Gradient of the index [Pa/m] if pressure is in proportion to the mean depth of what the cone presses: that of its
/// base and a third of its height. One bed of rough grains tells it to a few tenths, where the slope of a line through
/// its profile may be negative.
double proportional_gradient(const ConeResult& test);

/// The cone and its shaft as a closed mesh, with the base's centre at the origin and the tip down [m].
sim::TriangleMesh cone_mesh(double diameter, double shaft_length);

}  // namespace gonogo::terrain
