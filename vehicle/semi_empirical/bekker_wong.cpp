#include "vehicle/semi_empirical/bekker_wong.h"

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::vehicle {
namespace {

double modulus(const BekkerSoil& s, double width) { return s.k_c / width + s.k_phi; }

double shear(const BekkerSoil& s, double pressure, double displacement) {
  return (s.cohesion + pressure * std::tan(s.friction_angle)) * (1 - std::exp(-displacement / s.shear_modulus));
}

struct Stresses {
  double normal = 0, tangential = 0;  // [Pa]
};

/// Wong & Reece: behind the largest stress its front part is stretched over what is left to the exit at the lowest
/// point.
Stresses stresses(const BekkerSoil& s, double radius, double width, double slip, double entry, double largest,
                  double at) {
  const double mirrored = at >= largest ? at : entry - at / largest * (entry - largest);
  const double sinkage = radius * (std::cos(mirrored) - std::cos(entry));
  const double normal = modulus(s, width) * std::pow(std::fmax(sinkage, 0), s.n);
  const double displacement = radius * ((entry - at) - (1 - slip) * (std::sin(entry) - std::sin(at)));
  return {normal, shear(s, normal, displacement)};
}

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

WheelForces wheel_forces(const BekkerSoil& soil, double radius, double width, double slip, double entry_angle,
                         const WheelStress& stress) {
  const double largest = (stress.c1 + stress.c2 * slip) * entry_angle;
  WheelForces f;
  f.entry_angle = entry_angle;
  f.sinkage = radius * (1 - std::cos(entry_angle));
  // Midpoints, denser towards the entry, where a small exponent makes the stress rise steeply.
  constexpr int kParts = 2000;
  for (int i = 0; i < kParts; ++i) {
    const double a = 1.0 - double(i) / kParts, b = 1.0 - double(i + 1) / kParts;
    const double from = entry_angle * (1 - b * b), to = entry_angle * (1 - a * a);
    const double low = std::fmin(from, to), high = std::fmax(from, to), at = 0.5 * (low + high), part = high - low;
    const Stresses s = stresses(soil, radius, width, slip, entry_angle, largest, at);
    f.load += radius * width * part * (s.normal * std::cos(at) + s.tangential * std::sin(at));
    f.drawbar_pull += radius * width * part * (s.tangential * std::cos(at) - s.normal * std::sin(at));
    f.torque += radius * radius * width * part * s.tangential;
  }
  return f;
}

WheelForces wheel_forces_under(const BekkerSoil& soil, double radius, double width, double slip, double load,
                               const WheelStress& stress) {
  double low = 0, high = kPi / 2;
  if (wheel_forces(soil, radius, width, slip, high, stress).load < load)
    throw InputError("a load of " + number_text(load) + " N sinks the wheel to its axle in this soil");
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (wheel_forces(soil, radius, width, slip, middle, stress).load < load ? low : high) = middle;
  }
  return wheel_forces(soil, radius, width, slip, high, stress);
}

}  // namespace gonogo::vehicle
