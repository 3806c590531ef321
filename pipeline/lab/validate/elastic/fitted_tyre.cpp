#include "pipeline/lab/validate/elastic/fitted_tyre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "pipeline/lab/validate/elastic/measured_tyre.h"
#include "sim/elastic/tyre/modes.h"
#include "sim/elastic/tyre/press.h"
#include "sim/elastic/tyre/roll.h"

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
