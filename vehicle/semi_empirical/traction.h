// Semi-empirical traction of a wheel on soil of known cone index. Coefficients are forces over the wheel's load. They
// scatter: use them as bands around simulated drawbar pulls.
#pragma once
#include <cmath>

#include "base/units.h"

namespace gonogo::vehicle {

/// A wheel on soil.
struct WheelOnSoil {
  double load = 0;            // [N]
  double diameter = 0;        // unloaded [m]
  double width = 0;           // of the section [m]
  double section_height = 0;  // [m]
  double deflection = 0;      // on hard ground [m]
  double cone_index = 0;      // [Pa]
};

/// Shares of the wheel's load; net = gross - resistance.
struct Traction {
  double gross = 0, resistance = 0;
  double net() const { return gross - resistance; }
};

/// Wheel numeric C_n = CI b d / W.
inline double wheel_numeric(const WheelOnSoil& w) { return w.cone_index * w.width * w.diameter / w.load; }

/// Brixius, "Traction prediction equations for bias ply tires", ASAE paper 87-1622 (1987), in the form of MSU MAVS,
/// with the gross traction's constant 0.04 that MAVS leaves out:
///   B_n = C_n (1 + 5 deflection/height) / (1 + 3 width/diameter)
inline double brixius_number(const WheelOnSoil& w) {
  return wheel_numeric(w) * (1 + 5 * w.deflection / w.section_height) / (1 + 3 * w.width / w.diameter);
}

/// Radial tyres: slip rate 10.5 instead of 7.5; resistance 0.9 / B_n + 0.0325.
inline Traction brixius(const WheelOnSoil& w, double slip, bool radial) {
  const double b = brixius_number(w);
  const double gross = 0.88 * (1 - std::exp(-0.1 * b)) * (1 - std::exp(-(radial ? 10.5 : 7.5) * slip)) + 0.04;
  const double rolling = radial ? 0.9 / b + 0.0325 : 1 / b + 0.04;
  return {gross, rolling + 0.5 * slip / std::sqrt(b)};
}

/// Smallest pressure ratio for sand_net_traction. On firmer sand the fit is not monotone.
inline constexpr double kMinPressureRatio = 0.04;

/// Net traction on dry sand from braked to powered: Mason, Williams, Vahedifard & Priddy, "A unified equation for
/// predicting traction for wheels on sand over a range of braked, towed, and powered operations", J. Terramechanics 79
/// (2018), by MAVS. `pressure_ratio` is contact pressure over cone index, slip in [-1, 1].
inline double sand_net_traction(double pressure_ratio, double slip) {
  const double min = -0.5, max = 0.42 + 0.009 / pressure_ratio;
  const double a = 0.76 + 0.014 / pressure_ratio, c = 1.56 - 0.022 / pressure_ratio;
  return min + (max - min) / std::pow(1 + a * std::exp(-7 * slip), 1 / c);
}

/// Numeric of a wheel on sand: N_s = G (b d)^(3/2) deflection / (W height) with the cone index gradient G = CI / 3.47
/// in psi and psi/in (Turnage 1972; Mason et al. 2016).
inline double sand_numeric(const WheelOnSoil& w) {
  const double gradient = w.cone_index / 3.47 / kInch;  // [Pa/m]
  return gradient * std::pow(w.width * w.diameter, 1.5) * w.deflection / (w.load * w.section_height);
}

/// Gross traction of a powered wheel on sand, slip > 0 (Mason et al. 2016, by MAVS).
inline double sand_gross_traction(double numeric, double slip) {
  const double x = 0.66, y = 4.71 + 1.72 / slip;
  return x - x * y / (numeric + 10 + y);
}

/// Numeric of a wheel on clay (Detwiller et al. 2018, by MAVS).
inline double clay_numeric(const WheelOnSoil& w) {
  return wheel_numeric(w) /
         (std::pow(1 - w.deflection / w.section_height, 1.5) * std::pow(1 + w.width / w.diameter, 0.75));
}

/// Slip at which a wheel on clay just moves itself.
inline double clay_self_powered_slip(double numeric) { return 21 / std::pow(numeric, 2.5) + 0.005; }

/// Traction of a wheel on clay, slip > 0 (Detwiller et al. 2018, by MAVS): gross 1/2 log10(s / s_sp) (1 + b/d)^(1/4),
/// resistance 12 / N_c^2 + 0.007.
inline Traction clay_traction(const WheelOnSoil& w, double slip) {
  const double n = clay_numeric(w);
  return {0.5 * std::log10(slip / clay_self_powered_slip(n)) * std::pow(1 + w.width / w.diameter, 0.25),
          12 / (n * n) + 0.007};
}

}  // namespace gonogo::vehicle
