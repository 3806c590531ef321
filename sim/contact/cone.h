// Projection onto the cone of admissible contact impulses.
//   K = { (n, t, r) : n >= 0, |t| <= mu n, |r| <= rho n }
// n: normal impulse [N s]; t: friction impulse in the tangent plane [N s]; r: rolling-resistance impulse [N m s];
// mu: friction coefficient [-]; rho: rolling resistance [m]. Cohesion shifts the apex and is handled by the caller.
#pragma once
#include "base/vec.h"

namespace gonogo::sim {

struct ConeImpulse {
  Real normal = 0;
  Vec3 tangential, rolling;
};

/// Inverse metric of the projection, one positive step per component: minimises
///   (n - n0)^2 / step.n + |t - t0|^2 / step.t + |r - r0|^2 / step.r   over K.
struct ConeStep {
  Real n, t, r;
};

/// For a given n both friction parts are clipped to their radius, so the minimum is that of a convex, piecewise
/// quadratic function of n alone. Its pieces are told apart by which of the two is clipped; the right one is the one
/// whose minimum lies inside it.
GONOGO_HD inline ConeImpulse project_onto_cone(const ConeImpulse& p, Real mu, Real rho, const ConeStep& step) {
  const Real slide_square = dot(p.tangential, p.tangential), roll_square = dot(p.rolling, p.rolling);
  const Real n0 = p.normal;
  if (n0 >= 0 && slide_square <= mu * mu * n0 * n0 && roll_square <= rho * rho * n0 * n0) return p;  // inside
  const Real slide = std::sqrt(slide_square), roll = std::sqrt(roll_square);
  const Real slide_weight = mu / step.t, roll_weight = rho / step.r, normal_weight = 1 / step.n;
  // Clipped where n < slide / mu (roll / rho); compared by products, so that mu = 0 or rho = 0 need no special case.
  Real n = (normal_weight * n0 + slide_weight * slide + roll_weight * roll) /
           (normal_weight + slide_weight * mu + roll_weight * rho);
  if (!(slide > mu * n && roll > rho * n)) {  // not both are clipped: the one that clips up to a larger n is
    if (slide > mu * n0 && slide * rho >= roll * mu)
      n = (normal_weight * n0 + slide_weight * slide) / (normal_weight + slide_weight * mu);
    else
      n = (normal_weight * n0 + roll_weight * roll) / (normal_weight + roll_weight * rho);
  }
  if (n <= 0) return {};
  const Real slide_scale = slide > mu * n ? mu * n / slide : Real(1);
  const Real roll_scale = roll > rho * n ? rho * n / roll : Real(1);
  return {n, p.tangential * slide_scale, p.rolling * roll_scale};
}

}  // namespace gonogo::sim
