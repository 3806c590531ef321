#include "pipeline/lab/validate/elastic/measured_tyre.h"

#include <cmath>

namespace gonogo::lab::measured_tyre {
namespace {

constexpr double kNominalRadius = 0.3135;                                 // [m]
constexpr double kStiffness = 209651.5;                                   // VERTICAL_STIFFNESS [N/m]
constexpr double kSquareTerm = 15.416;                                    // Q_FZ2
constexpr double kPressureTerm = 0.7097;                                  // PFZ1
constexpr double kRoot = 0.6715, kLinear = 0.7308;                        // Q_RA1, Q_RA2
constexpr double kWideRoot = 1.0588, kWideLinear = -1.1863;               // Q_RB1, Q_RB2
constexpr double kLow = 8.39, kPeak = 0.2587, kHigh = 0.07355;            // BREFF, DREFF, FREFF
constexpr double kRoll = 0.00702, kRollV = 0.001515, kRollV4 = 8.514e-5;  // QSY1, QSY3, QSY4
constexpr double kRollLoad = 0.9008, kRollPressure = -0.4089;             // QSY7, QSY8

double stiffening(double pressure) { return 1 + kPressureTerm * (pressure - kPressure) / kPressure; }

}  // namespace

double deflection(double load, double pressure) {
  const double slope = kStiffness * kNominalRadius / kLoad, linear = std::sqrt(slope * slope - 4 * kSquareTerm);
  const double scaled = load / (kLoad * stiffening(pressure));
  return kNominalRadius * (std::sqrt(linear * linear + 4 * kSquareTerm * scaled) - linear) / (2 * kSquareTerm);
}

double contact_length(double load, double pressure) {
  const double scaled = load / (kStiffness * stiffening(pressure) * kNominalRadius);
  return 2 * kNominalRadius * (kLinear * scaled + kRoot * std::sqrt(scaled));
}

double contact_width(double load, double pressure) {
  const double scaled = load / (kStiffness * stiffening(pressure) * kNominalRadius);
  return 2 * kSectionWidth * (kWideLinear * scaled + kWideRoot * std::cbrt(scaled));
}

double rolling_radius(double load) {
  const double scaled = load / kLoad;
  return kRadius - kLoad / kStiffness * (kPeak * std::atan(kLow * scaled) + kHigh * scaled);
}

double rolling_moment(double load, double pressure, double speed) {
  const double v = speed / kSpeed;
  return kNominalRadius * kLoad * (kRoll + kRollV * v + kRollV4 * std::pow(v, 4)) * std::pow(load / kLoad, kRollLoad) *
         std::pow(pressure / kPressure, kRollPressure);
}

}  // namespace gonogo::lab::measured_tyre
