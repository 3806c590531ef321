// The direction in which two convex bodies are furthest apart, at least one of them an ellipsoid. Newton's method on
// the unit sphere maximises  f(n) = n.d - reach_a(n) - reach_b(n),  d from b's centre to a's, for bodies symmetric
// about their centres. The gradient of a reach is the furthest point, its Hessian the derivative of that point. Flat
// faces, edges and sides give f creases where n is square to an axis of the body; there the search follows the crease.
#pragma once
#include "sim/shape/convex.h"

namespace gonogo::sim {

struct Separation {
  Real gap;     // [m]
  Vec3 normal;  // from b to a
};

/// Whether an edge or side of the body runs along its axis k.
GONOGO_HD inline bool runs_along(const Convex& c, int k) {
  return c.type == ShapeType::box || (k == 1 && c.type != ShapeType::ellipsoid);
}

/// Furthest point along a unit direction, from the centre; the middle of an edge or side square to it.
GONOGO_HD inline Vec3 furthest(const Convex& c, const Vec3& direction) {
  const Vec3 n = c.into(direction);
  const auto end = [](Real toward, Real half) {
    return std::fabs(toward) < Real(1e-6) ? Real(0) : toward > 0 ? half : -half;
  };
  if (c.type == ShapeType::ellipsoid) return c.out_of(ellipsoid_support(c.size, n));
  if (c.type == ShapeType::box) return c.out_of({end(n.x, c.size.x), end(n.y, c.size.y), end(n.z, c.size.z)});
  if (c.type == ShapeType::capsule) return direction * c.size.x + c.axis[1] * end(n.y, c.size.y);
  const Real side = std::sqrt(n.x * n.x + n.z * n.z), out = side > 0 ? c.size.x / side : Real(0);
  return c.out_of({n.x * out, end(n.y, c.size.y), n.z * out});
}

/// u.H v with H the Hessian of the reach at the unit direction n [m].
GONOGO_HD inline Real reach_curvature(const Convex& c, const Vec3& n, const Vec3& u, const Vec3& v) {
  if (c.type == ShapeType::box) return 0;
  if (c.type == ShapeType::capsule) return c.size.x * dot(u, v);
  Vec3 own = c.into(n), p = c.into(u), q = c.into(v);
  if (c.type == ShapeType::cylinder) {
    own.y = p.y = q.y = 0;
    own = own * c.size.x;
    p = p * c.size.x;
    q = q * c.size.x;
  } else {
    own = scale(c.size, own);
    p = scale(c.size, p);
    q = scale(c.size, q);
  }
  const Real size = length(own);
  if (!(size > 0)) return 0;
  const Vec3 unit = own * (1 / size);
  return (dot(p, q) - dot(p, unit) * dot(q, unit)) / size;
}

struct Climb {
  const Convex &a, &b;

  GONOGO_HD Real gap(const Vec3& n) const { return dot(n, a.centre - b.centre) - extent(a, n) - extent(b, n); }

  GONOGO_HD Vec3 gradient(const Vec3& n) const { return a.centre - b.centre - furthest(a, n) - furthest(b, n); }

  /// u.M v with M the negative of f's Hessian on the sphere.
  GONOGO_HD Real curvature(const Vec3& n, const Vec3& u, const Vec3& v, Real gap) const {
    return reach_curvature(a, n, u, v) + reach_curvature(b, n, u, v) + gap * dot(u, v);
  }

  /// Newton's step from n. `crease`: zero, or a unit vector square to n to which the step stays square.
  GONOGO_HD Vec3 step(const Separation& s, const Vec3& crease) const {
    const Vec3& n = s.normal;
    const bool bound = dot(crease, crease) > 0;
    const Vec3 g = gradient(n), helper = std::fabs(n.x) < Real(0.6) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 across = bound ? cross(crease, n) : cross(helper, n), u = across * (1 / length(across));
    const Real uu = curvature(n, u, u, s.gap), gu = dot(g, u);
    if (bound) return uu > 0 ? u * (gu / uu) : Vec3{};
    const Vec3 v = cross(n, u);
    const Real uv = curvature(n, u, v, s.gap), vv = curvature(n, v, v, s.gap), gv = dot(g, v);
    const Real determinant = uu * vv - uv * uv;
    if (!(uu > 0 && determinant > 0)) return {};
    return u * ((gu * vv - gv * uv) / determinant) + v * ((gv * uu - gu * uv) / determinant);
  }

  GONOGO_HD_OUTLINED Separation along(Separation s, const Vec3& crease) const {
    for (int i = 0; i < 12; ++i) {
      const Vec3 whole = step(s, crease);
      const Real size = length(whole);
      if (!(size > Real(1e-6))) return s;
      Real share = size > Real(0.5) ? Real(0.5) / size : Real(1);
      bool higher = false;
      for (int k = 0; k < 4 && !higher; ++k, share *= Real(0.3)) {
        const Vec3 moved = s.normal + whole * share, n = moved * (1 / length(moved));
        const Real here = gap(n);
        higher = here > s.gap;
        if (higher) s = {here, n};
      }
      if (!higher) return s;
    }
    return s;
  }

  /// Climbs along the crease of axis k of a body, from its direction nearest to s.
  GONOGO_HD void along_crease(const Convex& c, int k, const Separation& from, Separation& best) const {
    const Real lean = dot(from.normal, c.axis[k]);
    if (!runs_along(c, k) || std::fabs(lean) > Real(0.3)) return;
    const Vec3 flat = from.normal - c.axis[k] * lean, n = flat * (1 / length(flat));
    const Separation found = along({gap(n), n}, c.axis[k]);
    if (found.gap > best.gap) best = found;
  }
};

/// The best direction near a good one. Every direction gives a lower bound of the gap, so the result is never worse.
GONOGO_HD_OUTLINED Separation highest_separation(const Convex& a, const Convex& b, const Separation& from) {
  const Climb climb{a, b};
  Separation best = climb.along(from, {});
  const Convex& other = is_strictly_convex(a) ? b : a;
  for (int k = 0; k < 3; ++k) climb.along_crease(other, k, best, best);
  return best;
}

}  // namespace gonogo::sim
