// Traction on a contact point by the law of law.h, with its slopes by the displacements. Inside sim/elastic.
#pragma once
#include "sim/elastic/law.h"
#include "sim/elastic/project.h"

namespace gonogo::sim::elastic {

/// Friction per c_t w^m_t: psi'(|v|) v / |v|, also at rest.
template <class T>
Vec3T<T> friction_direction(const Vec3T<T>& v, double epsilon) {
  const T square = dot(v, v);
  if (!(value_of(square) > 1e-24 * epsilon * epsilon)) return v * T(2 / epsilon);
  const T speed = root(square);
  if (value_of(speed) < epsilon) return v * ((T(2) - speed / T(epsilon)) / T(epsilon));
  return v * (T(1) / speed);
}

template <int N>
struct Traction3 {
  Dual<N> pressure{};
  Vec3T<Dual<N>> shear{}, sliding{};
};

/// Of an overlap; the law of law.h.
template <int N>
Traction3<N> traction_of(const ContactLaw& law, const Gap<Dual<N>>& gap, const Vec3T<Dual<N>>& velocity) {
  Traction3<N> t;
  const Dual<N> w = -gap.gap;
  t.pressure = Dual<N>(law.c_n) * power(w, law.m_n);
  t.sliding = velocity - gap.normal * dot(velocity, gap.normal);
  if (law.c_t > 0) t.shear = friction_direction(t.sliding, law.epsilon) * (Dual<N>(-law.c_t) * power(w, law.m_t));
  return t;
}

}  // namespace gonogo::sim::elastic
