// Projection onto the cone of admissible contact impulses.
//   K = { (n, t, r) : n >= 0, |t| <= mu n, |r| <= rho n }
// n: normal impulse [N s]; t: friction impulse in the tangent plane [N s]; r: rolling-resistance impulse [N m s];
// mu: friction coefficient [-]; rho: rolling resistance [m]. Cohesion shifts the apex and is handled by the caller.
// T is Real, or Pack for eight contacts at once.
#pragma once
#include "base/pack.h"

namespace gonogo::sim {

template <class T>
struct ConeImpulseT {
  T normal{};
  Vec3T<T> tangential, rolling;
};

/// Inverse metric of the projection, one positive step per component: minimises
///   (n - n0)^2 / step.n + |t - t0|^2 / step.t + |r - r0|^2 / step.r   over K.
template <class T>
struct ConeStepT {
  T n, t, r;
};

using ConeImpulse = ConeImpulseT<Real>;
using ConeStep = ConeStepT<Real>;

/// For a given n both friction parts are clipped to their radius, so the minimum is that of a convex, piecewise
/// quadratic function of n alone. Its pieces are told apart by which of the two is clipped; the right one is the one
/// whose minimum lies inside it. Free of branches, so that eight contacts can take different pieces.
template <class T>
GONOGO_HD_INLINED ConeImpulseT<T> project_onto_cone(const ConeImpulseT<T>& p, const T& mu, const T& rho,
                                                    const ConeStepT<T>& step) {
  const T one = constant<T>(1), zero = constant<T>(0);
  const T slide = square_root(dot(p.tangential, p.tangential)), roll = square_root(dot(p.rolling, p.rolling));
  const T n0 = p.normal;
  const T normal_weight = one / step.n, slide_weight = mu / step.t, roll_weight = rho / step.r;
  const T free_sum = normal_weight * n0, slide_sum = slide_weight * slide, roll_sum = roll_weight * roll;
  const T n_both = (free_sum + slide_sum + roll_sum) / (normal_weight + slide_weight * mu + roll_weight * rho);
  const T n_slide = (free_sum + slide_sum) / (normal_weight + slide_weight * mu);
  const T n_roll = (free_sum + roll_sum) / (normal_weight + roll_weight * rho);
  // Clipped where n < slide / mu (roll / rho); compared by products, so that mu = 0 or rho = 0 need no special case.
  // When not both are clipped, the one that clips up to a larger n is.
  const auto slide_clips = slide > mu * n0, roll_clips = roll > rho * n0;
  const T n_one = select(both(slide_clips, slide * rho >= roll * mu), n_slide, n_roll);
  const T n_clipped = select(both(slide > mu * n_both, roll > rho * n_both), n_both, n_one);
  const T n_any = select(either(slide_clips, roll_clips), n_clipped, n0);
  const T n = select(n_any > zero, n_any, zero);
  const T slide_scale = select(slide > mu * n, mu * n / slide, one);
  const T roll_scale = select(roll > rho * n, rho * n / roll, one);
  return {n, p.tangential * slide_scale, p.rolling * roll_scale};
}

GONOGO_HD inline ConeImpulse project_onto_cone(const ConeImpulse& p, Real mu, Real rho, const ConeStep& step) {
  return project_onto_cone<Real>(p, mu, rho, step);
}

}  // namespace gonogo::sim
