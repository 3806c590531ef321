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
  const Real slide = length(p.tangential), roll = length(p.rolling);
  const Real n0 = p.normal;
  // Clipped when n < slide / mu (roll / rho); compared by products, so that mu = 0 or rho = 0 need no special case.
  const bool slide_clips = slide > mu * n0, roll_clips = roll > rho * n0;
  Real n = n0;
  if (slide_clips || roll_clips) {
    const Real slide_weight = mu / step.t, roll_weight = rho / step.r;
    const Real both = (n0 / step.n + slide_weight * slide + roll_weight * roll) /
                      (1 / step.n + slide_weight * mu + roll_weight * rho);
    if (slide > mu * both && roll > rho * both) {
      n = both;
    } else if (slide_clips && slide * rho >= roll * mu) {  // sliding clips up to a larger n than rolling does
      n = (n0 / step.n + slide_weight * slide) / (1 / step.n + slide_weight * mu);
    } else {
      n = (n0 / step.n + roll_weight * roll) / (1 / step.n + roll_weight * rho);
    }
  }
  if (n <= 0) return {};
  const Real slide_scale = slide > mu * n ? mu * n / slide : Real(1);
  const Real roll_scale = roll > rho * n ? rho * n / roll : Real(1);
  return {n, p.tangential * slide_scale, p.rolling * roll_scale};
}

}  // namespace gonogo::sim
