#include "vehicle/semi_empirical/bekker_wong.h"

#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::vehicle {
namespace {

double modulus(const BekkerSoil& s, double width) { return s.k_c / width + s.k_phi; }

/// Share of its limit that a shear stress has reached, with the sign of the displacement.
double mobilised(double displacement, double k) {
  return std::copysign(1 - std::exp(-std::fabs(displacement) / k), displacement);
}

/// Cohesion and friction with what shears beside the lugs.
BekkerSoil with_lugs(BekkerSoil soil, const RigidWheel& wheel) {
  if (!(wheel.lug_height > 0)) return soil;
  const double ratio = wheel.lug_height / wheel.width;
  soil.cohesion *= 1 + 2 * ratio;
  soil.friction_angle = std::atan(std::tan(soil.friction_angle) * (1 + 0.64 * ratio * std::atan2(1, ratio)));
  return soil;
}

struct Stresses {
  double normal = 0, tangential = 0, sideways = 0;  // [Pa]
};

/// A wheel in one state of motion at one entry angle.
struct WheelInSoil {
  const BekkerSoil& soil;
  double radius, width;       // over the lugs [m]
  double along, across;       // speed of the axle along and across the heading, over that of the tips
  double entry, largest = 0;  // angles of entry and of the largest normal stress [rad]

  /// Wong & Reece: behind the largest stress its front part is stretched over what is left to the exit at the lowest
  /// point.
  Stresses at(double angle) const {
    const double mirrored = angle >= largest ? angle : entry - angle / largest * (entry - largest);
    const double normal = modulus(soil, width) * std::pow(std::fmax(depth(mirrored), 0), soil.n);
    const double limit = soil.cohesion + normal * std::tan(soil.friction_angle);
    const double ahead = radius * ((entry - angle) - along * (std::sin(entry) - std::sin(angle)));
    const double aside = radius * across * (entry - angle);
    return {normal, limit * mobilised(ahead, soil.shear_modulus), limit * mobilised(aside, soil.shear_modulus)};
  }
  /// Below the surface, of the point of the wheel at this angle [m].
  double depth(double angle) const { return radius * (std::cos(angle) - std::cos(entry)); }

  /// Soil that a side of the wheel pushes, per metre along it [N/m].
  double pushed(double depth) const {
    const double phi = soil.friction_angle;
    if (across == 0 || !(phi > 0)) return 0;
    const double x = kPi / 4 - phi / 2, cot = 1 / std::tan(x);
    const double d1 = cot + std::tan(x + phi), d2 = cot + cot * cot * std::tan(phi);
    return std::copysign(d1 * (soil.cohesion * depth + 0.5 * d2 * soil.unit_weight * depth * depth), across);
  }

  void add(double angle, double part, WheelForces& f) const {
    const Stresses s = at(angle);
    const double area = radius * width * part;
    f.load += area * (s.normal * std::cos(angle) + s.tangential * std::sin(angle));
    f.drawbar_pull += area * (s.tangential * std::cos(angle) - s.normal * std::sin(angle));
    f.torque += radius * area * s.tangential;
    const double h = depth(angle);
    f.side += area * s.sideways + part * pushed(h) * (radius - h * std::cos(angle));
  }
};

}  // namespace

double plate_pressure(const BekkerSoil& soil, double width, double sinkage) {
  return modulus(soil, width) * std::pow(sinkage, soil.n);
}

double plate_sinkage(const BekkerSoil& soil, double width, double pressure) {
  return std::pow(pressure / modulus(soil, width), 1 / soil.n);
}

TrackForces track_forces(const BekkerSoil& soil, double width, double length, double load, double slip) {
  TrackForces f;
  f.sinkage = plate_sinkage(soil, width, load / (width * length));
  f.resistance = width * modulus(soil, width) * std::pow(f.sinkage, soil.n + 1) / (soil.n + 1);
  // Janosi & Hanamoto: the shear displacement grows linearly, j = slip x.
  const double reach = slip * length / soil.shear_modulus;
  const double share = reach > 1e-9 ? 1 - (1 - std::exp(-reach)) / reach : 0.5 * reach;
  f.thrust = (width * length * soil.cohesion + load * std::tan(soil.friction_angle)) * share;
  return f;
}

WheelForces wheel_forces(const BekkerSoil& soil, const RigidWheel& wheel, const WheelMotion& motion, double entry_angle,
                         const WheelStress& stress) {
  const BekkerSoil sheared = with_lugs(soil, wheel);
  const double speed = 1 - motion.slip, along = speed * std::cos(motion.slip_angle);
  const double slip_along = std::fmax(-1, 1 - along);
  const WheelInSoil in{.soil = sheared,
                       .radius = wheel.reach(),
                       .width = wheel.width,
                       .along = along,
                       .across = speed * std::sin(motion.slip_angle),
                       .entry = entry_angle,
                       .largest = (stress.c1 + stress.c2 * slip_along) * entry_angle};
  WheelForces f{.entry_angle = entry_angle, .sinkage = in.depth(0)};
  // Midpoints, denser towards the entry, where a small exponent makes the stress rise steeply.
  constexpr int kParts = 2000;
  for (int i = 0; i < kParts; ++i) {
    const double a = 1.0 - double(i) / kParts, b = 1.0 - double(i + 1) / kParts;
    const double from = entry_angle * (1 - b * b), to = entry_angle * (1 - a * a);
    in.add(0.5 * (from + to), std::fabs(from - to), f);
  }
  return f;
}

WheelForces wheel_forces_under(const BekkerSoil& soil, const RigidWheel& wheel, const WheelMotion& motion, double load,
                               const WheelStress& stress) {
  double low = 0, high = kPi / 2;
  if (wheel_forces(soil, wheel, motion, high, stress).load < load)
    throw InputError("a load of " + number_text(load) + " N sinks the wheel to its axle in this soil");
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (wheel_forces(soil, wheel, motion, middle, stress).load < load ? low : high) = middle;
  }
  return wheel_forces(soil, wheel, motion, high, stress);
}

}  // namespace gonogo::vehicle
