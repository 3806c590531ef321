// Virtual plate sinkage test: a plate as long as the periodic bed is wide is pressed into it by a growing load. Two
// plate widths b give Bekker's p = (k_c / b + k_phi) z^n (Bekker, Introduction to Terrain-Vehicle Systems, 1969).
//
// The load is prescribed, as in a bevameter. At a prescribed speed, rigid grains jam under the plate and burst away,
// and the pressure jumps between zero and several times its mean. The load grows exponentially, so that samples are
// evenly spaced in ln p on every soil.
#pragma once
#include "terrain/soil_test/line_fit.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::terrain {

struct PlateSettings {
  double width_grains = 6;     // of the plate, in grain diameters
  double sinkage = 0.5;        // at the end of the test, in plate widths
  double growth_time = 6;      // time in which the load grows by a quarter, in sqrt(d / g)
  double max_pressure = 3e6;   // the test ends here if the sinkage is not reached [Pa]
  double bed_depth = 3;        // in plate widths; at least 8 grains
  double datum = 1e3;          // pressure at zero sinkage [Pa]
  double steps_per_time = 50;  // in sqrt(d / g)
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
PowerLaw fit_power_law(const PlateResult& plate);

/// Bekker's parameters from several plates with a common exponent.
struct BekkerFit {
  double k_c = 0, k_phi = 0, n = 0;  // [N/m^(n+1)], [N/m^(n+2)], [-]
  double k_c_error = 0, k_phi_error = 0, n_error = 0;
  double r2 = 0;  // of ln p
};
BekkerFit fit_bekker(const std::vector<PlateResult>& plates);

}  // namespace gonogo::terrain
