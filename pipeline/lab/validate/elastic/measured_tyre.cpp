#include "pipeline/lab/validate/elastic/measured_tyre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "sim/elastic/tyre/press.h"
#include "sim/elastic/tyre/roll.h"

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

namespace gonogo::lab {
namespace {

namespace el = sim::elastic;
namespace measured = measured_tyre;

// Assumed, and of little influence: see docs/elastic.md.
constexpr double kTread = 3e8;    // modulus over thickness: 4 MPa, two thirds of the area, 9 mm [Pa/m]
constexpr double kStretch = 2e6;  // EA of the belt [N]

void fit_springs(el::Tyre& t) {
  t.tangential = 0;
  const double rest = measured::turn_stiffness() - el::sidewall_stiffness(t).turn;
  t.tangential = rest / (2 * std::numbers::pi * std::pow(t.belt_radius(), 3));
}

double length_ratio(const el::Tyre& t) {
  return pressed(t, measured::kLoad).length / measured::contact_length(measured::kLoad, measured::kPressure);
}

}  // namespace

Patch pressed(const el::Tyre& tyre, double load) {
  el::PressedTyre p(tyre, 1.05 * tyre.radius);
  const double unloaded = p.node(0).x + tyre.tread;  // the air widens the belt
  if (!p.carry(load)) throw DeviceError("tyre: no balance under the load: " + p.reason());
  return {unloaded - p.rim().y, p.contact_length()};
}

/// Secants on logarithms: the contact is about the shorter the stiffer the belt.
el::Tyre fitted_tyre(int nodes) {
  const double width = measured::contact_width(measured::kLoad, measured::kPressure);
  el::Tyre t{.radius = measured::kRadius,
             .tread = measured::kRadius - measured::rolling_radius(measured::kLoad),
             .rim_radius = measured::kRimRadius,
             .width = width,
             .bulge = (measured::kSectionWidth - width) / 2,
             .pressure = measured::kPressure,
             .bending = 4,
             .stretching = kStretch,
             .belt_mass = measured::kBeltMass,
             .nodes = nodes,
             .law = el::penalty_law(kTread, 0, 1e-2)};
  fit_springs(t);
  double x = std::log(t.bending), miss = std::log(length_ratio(t)), next = x + 0.2;
  for (int i = 0; i < 12 && std::fabs(miss) > 2e-3; ++i) {
    t.bending = std::exp(next);
    const double now = std::log(length_ratio(t)), slope = (now - miss) / (next - x);
    x = next;
    miss = now;
    next = x - std::clamp(miss / slope, -0.5, 0.5);
  }
  if (std::fabs(miss) > 0.01) throw DeviceError("tyre: the bending stiffness could not be fitted");
  return t;
}

Rolling rolling(el::Tyre tyre, double load, double pressure) {
  tyre.pressure = pressure;
  const double mass = load / 9.81, stiffness = load / measured::deflection(load, pressure);
  el::RollingTyre t(tyre, {.speed = measured::kSpeed,
                           .spin = -measured::kSpeed / tyre.belt_radius(),
                           .load = load,
                           .mass = mass,
                           .damping = 2 * 0.4 * std::sqrt(stiffness * mass)});
  const double step = 0.9 * t.critical_step();
  el::roll(t, step, 2);
  const el::RollMeans m = el::roll(t, step, 2);
  return {m.torque, t.energy().balance() / t.energy().work, m.worked, m.lost};
}

double fitted_loss(const el::Tyre& tyre) {
  el::Tyre t = tyre;
  const double wanted = measured::rolling_moment(measured::kLoad, measured::kPressure, measured::kSpeed);
  t.loss = 0.2;
  for (int i = 0; i < 3; ++i) {
    const double moment = rolling(t, measured::kLoad, measured::kPressure).moment;
    if (std::fabs(moment / wanted - 1) < 5e-3) break;
    t.loss *= wanted / moment;
  }
  return t.loss;
}

}  // namespace gonogo::lab
