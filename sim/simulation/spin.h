// Free rotation of a body over one step. Let L = I w be the momentum in body axes. The implicit midpoint rule for
// Euler's equation, with the Cayley rotation of `turned`, is
//     L+ - L = -h w x (I w),   w = I^-1 (L + L+) / 2,   R+ = R cay(h w).
// It keeps every quadratic invariant, so |L|, the momentum in world axes and the energy 1/2 L . I^-1 L are exact
// (Austin, Krishnaprasad, Wang 1993). The engine stores w, the mean of a step, which in body axes is the same before
// and after the turn. The momentum at the step's end is I w - h/2 w x I w, and the next mean w' solves
//     I w' + h/2 w' x I w' = I w - h/2 w x I w.
#pragma once
#include "base/vec.h"

namespace gonogo::sim {

/// Moment of inertia of an axis; 0 for an axis that cannot turn (inverse 0).
GONOGO_HD inline Real moment_of(Real inverse) { return inverse > 0 ? 1 / inverse : 0; }

/// x with A x = b, A given by its columns (Cramer's rule).
GONOGO_HD inline Vec3 solve3(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& right) {
  const Vec3 bc = cross(b, c);
  const Real inverse = 1 / dot(a, bc);
  return {dot(right, bc) * inverse, dot(a, cross(right, c)) * inverse, dot(a, cross(b, right)) * inverse};
}

/// Change of the mean angular velocity from the last step to the next, in body axes [rad/s].
GONOGO_HD inline Vec3 free_spin_change_B(const Vec3& inverse_inertia_B, const Vec3& w_B, Real step) {
  const Vec3 inertia{moment_of(inverse_inertia_B.x), moment_of(inverse_inertia_B.y), moment_of(inverse_inertia_B.z)};
  const Real half = step / 2;
  // The unknown is the change d of w, so that only it is rounded: F(d) = 0, F' = I + h/2 (w'^ I - (I w')^).
  const Vec3 momentum = scale(inertia, w_B), rate = half * cross(w_B, momentum);
  const Vec3 free{inertia.x > 0 ? Real(1) : 0, inertia.y > 0 ? Real(1) : 0, inertia.z > 0 ? Real(1) : 0};
  const Vec3 held = Vec3{1, 1, 1} - free;
  Vec3 d;
  for (int newton = 0; newton < 3; ++newton) {
    const Vec3 w = w_B + d, l = scale(inertia, w);
    const Vec3 miss = scale(free, scale(inertia, d) + half * cross(w, l) + rate);
    const auto column = [&](const Vec3& e) {
      return scale(free, scale(inertia, e) + half * (cross(w, scale(inertia, e)) + cross(e, l))) + scale(held, e);
    };
    d -= solve3(column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1}), miss);
  }
  return d;
}

}  // namespace gonogo::sim
