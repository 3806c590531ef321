// Projection onto the cone of admissible contact impulses.
//   K = { (n, t, r, s) : n >= 0, |t| <= mu n, |r| <= rho n, |s| <= sigma n }
// n: normal impulse [N s]; t: friction impulse in the tangent plane [N s]; r: rolling-resistance impulse in the tangent
// plane [N m s]; s: spinning-resistance impulse about the normal [N m s]; mu: friction coefficient [-]; rho, sigma:
// rolling and spinning resistance [m]. Cohesion shifts the apex and is handled by the caller. T is Real, or Pack for
// eight contacts at once.
#pragma once
#include "base/pack.h"

namespace gonogo::sim {

template <class T>
struct ConeImpulseT {
  T normal{};
  Vec3T<T> tangential, rolling;
  T spinning{};
};

/// Opening of the cone.
template <class T>
struct ConeShapeT {
  T mu, rho, sigma;
};

/// Inverse metric of the projection, one positive step per component: minimises
///   (n - n0)^2 / step.n + |t - t0|^2 / step.t + (|r - r0|^2 + (s - s0)^2) / step.r   over K.
template <class T>
struct ConeStepT {
  T n, t, r;
};

using ConeImpulse = ConeImpulseT<Real>;
using ConeShape = ConeShapeT<Real>;
using ConeStep = ConeStepT<Real>;

template <class T>
GONOGO_HD_INLINED T magnitude(const T& x) {
  return select(x < constant<T>(0), -x, x);
}

/// Nearest point of K. For a given n every friction part is clipped to its radius, so what is left is to minimise a
/// convex, piecewise quadratic function of n. Its derivative rises and is concave: Newton's method climbs from n0 to
/// the root without passing it, in at most one pass per clipped part. There are no branches, so that the eight contacts
/// of a Pack may lie on different pieces. `turning`: rolling and spinning parts exist.
template <bool turning, class T>
GONOGO_HD_INLINED ConeImpulseT<T> project_onto_cone(const ConeImpulseT<T>& p, const ConeShapeT<T>& cone,
                                                    const ConeStepT<T>& step) {
  const T one = constant<T>(1), zero = constant<T>(0);
  const T slide = quick_root(dot(p.tangential, p.tangential));
  T roll{}, spin{};
  // Weights of the parts, multiplied by the steps of all, so that each pass divides once.
  T normal_weight = step.t, slide_weight = cone.mu * step.n, roll_weight{}, spin_weight{};
  if constexpr (turning) {
    roll = quick_root(dot(p.rolling, p.rolling));
    spin = magnitude(p.spinning);
    roll_weight = cone.rho * step.n * step.t;
    spin_weight = cone.sigma * step.n * step.t;
    normal_weight = step.t * step.r;
    slide_weight = slide_weight * step.r;
  }
  T n = p.normal;
  for (int pass = 0; pass < (turning ? 3 : 1); ++pass) {
    const T slides = select(slide > cone.mu * n, slide_weight, zero);
    T sum = normal_weight * p.normal + slides * slide, weight = normal_weight + slides * cone.mu;
    if constexpr (turning) {
      const T rolls = select(roll > cone.rho * n, roll_weight, zero);
      const T spins = select(spin > cone.sigma * n, spin_weight, zero);
      sum += rolls * roll + spins * spin;
      weight += rolls * cone.rho + spins * cone.sigma;
    }
    n = select(sum == normal_weight * p.normal, p.normal, quick_ratio(sum, weight));
  }
  n = select(n > zero, n, zero);
  ConeImpulseT<T> q;
  q.normal = n;
  q.tangential = p.tangential * select(slide > cone.mu * n, quick_ratio(cone.mu * n, slide), one);
  if constexpr (turning) {
    q.rolling = p.rolling * select(roll > cone.rho * n, quick_ratio(cone.rho * n, roll), one);
    q.spinning = p.spinning * select(spin > cone.sigma * n, quick_ratio(cone.sigma * n, spin), one);
  }
  return q;
}

GONOGO_HD inline ConeImpulse project_onto_cone(const ConeImpulse& p, const ConeShape& cone, const ConeStep& step) {
  return project_onto_cone<true, Real>(p, cone, step);
}

}  // namespace gonogo::sim
