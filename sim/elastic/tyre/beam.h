// A straight beam of a plane frame that may move and turn by any amount: strains are small in a frame that goes with
// the chord (Crisfield, Non-linear finite element analysis of solids and structures, volume 1, 1991, chapter 7).
// Degrees of freedom: x, y, turn of both ends. For plain numbers and for Dual.
#pragma once
#include <array>
#include <cmath>
#include <numbers>

#include "sim/elastic/dual.h"

namespace gonogo::sim::elastic {

/// Stretch of the chord [m], turns of both ends against it [rad].
template <class T>
using BeamStrain = std::array<T, 3>;

/// Undeformed: length [m], direction of the chord.
struct BeamShape {
  double length = 0, c = 1, s = 0;
};

template <class T>
struct Chord {
  T length{}, c{}, s{};
  BeamStrain<T> strain{};
};

/// The multiple of a full turn nearest to an angle.
inline double full_turns(double angle) { return 2 * std::numbers::pi * std::round(angle / (2 * std::numbers::pi)); }

template <class T>
Chord<T> chord_of(const BeamShape& shape, const std::array<T, 6>& x) {
  const T dx = x[3] - x[0], dy = x[4] - x[1];
  Chord<T> k;
  k.length = root(dx * dx + dy * dy);
  k.c = dx / k.length;
  k.s = dy / k.length;
  const T turn = angle(k.s * T(shape.c) - k.c * T(shape.s), k.c * T(shape.c) + k.s * T(shape.s));
  k.strain = {k.length - T(shape.length), x[2] - turn, x[5] - turn};
  for (int i = 1; i < 3; ++i) k.strain[i] -= T(full_turns(value_of(k.strain[i])));
  return k;
}

/// Normal force [N] and moments at both ends [N m].
template <class T>
BeamStrain<T> beam_stress(double stretching, double bending, double length, const BeamStrain<T>& strain) {
  const double n = stretching / length, m = bending / length;
  return {T(n) * strain[0], T(4 * m) * strain[1] + T(2 * m) * strain[2], T(2 * m) * strain[1] + T(4 * m) * strain[2]};
}

/// Forces of the beam on its ends, minus the gradient of its energy.
template <class T>
std::array<T, 6> beam_force(const Chord<T>& k, const BeamStrain<T>& stress) {
  const T across = (stress[1] + stress[2]) / k.length;  // shear force
  const T fx = k.c * stress[0] + k.s * across, fy = k.s * stress[0] - k.c * across;
  return {fx, fy, -stress[1], -fx, -fy, -stress[2]};
}

}  // namespace gonogo::sim::elastic
