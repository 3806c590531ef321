// Contacts of two convex bodies (capsule, ellipsoid, cylinder, box). Their signed distance is the largest separation
// over all directions,
//   max over |n| = 1 of  n.d - reach_a(-n) - reach_b(n),   d: from b's centre to a's,
// positive when they are apart. Where faces, caps or pairs of edges touch, their own directions are exact. Otherwise
// the direction is the line between the nearest points of the cores (alternating projections). The contacts are the
// corners and crossings of the two facets that face each other. For an ellipsoid Newton's method improves the best
// direction (Climb), and its furthest point is the contact.
//
// The direction in which two convex bodies are furthest apart, at least one of them an ellipsoid. Newton's method on
// the unit sphere maximises  f(n) = n.d - reach_a(n) - reach_b(n),  d from b's centre to a's, for bodies symmetric
// about their centres. The gradient of a reach is the furthest point, its Hessian the derivative of that point. Flat
// faces, edges and sides give f creases where n is square to an axis of the body; there the search follows the crease.
#pragma once
#include <initializer_list>

#include "sim/shape/touch/convex.h"

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

struct SeparationSearch {
  const Convex &a, &b;
  Separation best{Real(-1e30), {0, 0, 1}};
  Vec3 near_a{}, near_b{};  // nearest points of the cores
  bool by_nearest = false;  // the best direction is the line between them

  /// Keeps a unit direction if it separates better than the best so far by more than the handicap. Returns its gap.
  GONOGO_HD Real consider(Vec3 n, Real handicap) {
    const Vec3 d = a.centre - b.centre;
    if (dot(n, d) < 0) n = -n;
    const Real gap = dot(n, d) - extent(a, n) - extent(b, n);
    if (gap > best.gap + handicap) best = {gap, n};
    return gap;
  }

  /// Midway between the surfaces, on the line through the nearest points.
  GONOGO_HD Vec3 middle() const {
    const Vec3& n = best.normal;
    const Real out_a = dot(n, near_a - a.centre) + extent(a, n), out_b = extent(b, n) - dot(n, near_b - b.centre);
    return (near_a - n * out_a + near_b + n * out_b) * Real(0.5);
  }

  GONOGO_HD void consider_flats(const Convex& c, Real handicap) {
    if (c.type == ShapeType::box) {
      consider(c.axis[0], handicap);
      consider(c.axis[2], handicap);
    }
    if (c.type == ShapeType::cylinder || c.type == ShapeType::box) consider(c.axis[1], handicap);
  }

  /// The line between the centres, which proves most distant pairs apart.
  GONOGO_HD void consider_centres() {
    const Vec3 d = a.centre - b.centre;
    const Real distance = length(d);
    if (distance > 0) consider(d * (1 / distance), 0);
  }

  /// Climbs from the best direction and from the line between the nearest points: the best may be a flat face, and the
  /// climb cannot leave its crease.
  GONOGO_HD void climb() {
    const Separation from = best;
    best = highest_separation(a, b, from);
    const Vec3 apart = near_a - near_b;
    const Real distance = length(apart);
    if (by_nearest || !(distance > 0)) return;
    const Vec3 n = apart * (1 / distance);
    const Separation other = highest_separation(a, b, {dot(n, a.centre - b.centre) - extent(a, n) - extent(b, n), n});
    if (other.gap > best.gap) best = other;
  }

  /// Directions square to an edge or axis of either body.
  GONOGO_HD void consider_edges(Real handicap) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        if (!runs_along(a, i) || !runs_along(b, j)) continue;
        const Vec3 n = cross(a.axis[i], b.axis[j]);
        const Real sine = length(n);
        if (sine > Real(0.03)) consider(n * (1 / sine), handicap);
      }
  }

  /// Alternating projections between two convex sets converge to their nearest points (Cheney & Goldstein 1959). They
  /// are gradient steps on the squared distance to a, so they take momentum with restart as in state/momentum.h. Nearly
  /// parallel bodies would need thousands of steps without.
  GONOGO_HD void improve_nearest(Real share, Real scale, Vec3& p, Vec3& q) const {
    Vec3 from = q;
    Real t = 1;
    for (int i = 0; i < 48; ++i) {
      p = nearest_in_core(a, from, share);
      const Vec3 next = nearest_in_core(b, p, share), moved = next - q;
      if (dot(from - next, moved) > 0) t = 1;
      const Real t_next = (1 + std::sqrt(1 + 4 * t * t)) / 2;
      from = next + moved * ((t - 1) / t_next);
      t = t_next;
      q = next;
      if (dot(moved, moved) < Real(1e-12) * scale * scale) break;
    }
    p = nearest_in_core(a, q, share);
  }

  /// From small cores, whose nearest points are found fast, to the whole bodies, whose nearest points are exact while
  /// they are well apart. Every direction is a lower bound, so the best one is kept, with the points of the last one
  /// that is as good.
  GONOGO_HD void consider_nearest(Real scale, Real handicap) {
    Vec3 p = a.centre, q = b.centre;
    for (const Real share : {Real(0.1), Real(0.02), Real(0)}) {
      improve_nearest(share, scale, p, q);
      const Vec3 apart = p - q;
      const Real distance = length(apart), before = best.gap;
      if (distance < Real(2e-3) * scale) break;
      const Real gap = consider(apart * (1 / distance), by_nearest ? Real(0) : handicap);
      if (gap > before - Real(0.1) * handicap || share == Real(0.1)) {
        near_a = p;
        near_b = q;
      }
      by_nearest = by_nearest || best.gap > before;
    }
  }
};

/// Whether `p` lies in a face seen along `n`.
GONOGO_HD inline bool in_facet(const Facet& f, const Vec3& p, const Vec3& n, Real tolerance) {
  Real low = 0, high = 0;
  for (int k = 0; k < f.count; ++k) {
    const Vec3 edge = f.point[(k + 1) % f.count] - f.point[k];
    const Real side = dot(cross(n, edge), p - f.point[k]) / length(edge);
    low = std::fmin(low, side);
    high = std::fmax(high, side);
  }
  return low >= -tolerance || high <= tolerance;
}

/// Contacts of two facets seen along the normal. Features name corners and edges of the bodies, so they do not depend
/// on which body has the face: 256 + corner of a, 512 + corner of b, 2^20 + 1024 edge of a + edge of b.
template <class Visit>
struct FacetPair {
  const Facet &a, &b;
  const Vec3& n;
  Real scale;
  Visit& visit;
  Real least = Real(1e30);  // gap found
  int count = 0;
  Vec3 seen[2 * kMaxCorners + 8]{};

  /// Skips points already visited: a corner on an edge of the other facet would be met twice.
  GONOGO_HD void add(int feature, Real gap, const Vec3& middle) {
    for (int k = 0; k < count; ++k) {
      const Vec3 apart = middle - seen[k];
      if (dot(apart, apart) < Real(1e-6) * scale * scale) return;
    }
    if (count < 2 * kMaxCorners + 8) seen[count++] = middle;
    least = std::fmin(least, gap);
    visit(feature, gap, middle);
  }

  GONOGO_HD static int edge_name(const Facet& f, int k) {
    const int p = f.id[k], q = f.id[(k + 1) % f.count];
    return p < q ? 32 * p + q : 32 * q + p;
  }

  /// Corners of `of` inside the face `in`; `sign` 1 when `of` belongs to a.
  GONOGO_HD void corners(const Facet& of, const Facet& in, int name, Real sign) {
    for (int k = 0; k < of.count; ++k) {
      if (!in_facet(in, of.point[k], n, Real(1e-4) * scale)) continue;
      const Real gap = sign * dot(of.point[k] - in.point[0], in.normal) / dot(n, in.normal);
      add(name + of.id[k], gap, of.point[k] - n * (sign * gap / 2));
    }
  }

  GONOGO_HD void crossing(int i, int k, Real parallel) {
    const Vec3 from_a = a.point[i], from_b = b.point[k];
    const Vec3 u = a.point[(i + 1) % a.count] - from_a, v = b.point[(k + 1) % b.count] - from_b, w = from_b - from_a;
    const Real area = dot(cross(u, v), n), edge = Real(1e-4);
    if (std::fabs(area) < parallel * length(u) * length(v)) return;
    const Real s = dot(cross(w, v), n) / area, t = dot(cross(w, u), n) / area;
    if (s < -edge || s > 1 + edge || t < -edge || t > 1 + edge) return;
    const Vec3 on_a = from_a + u * s, on_b = from_b + v * t;
    add((1 << 20) + (edge_name(a, i) << 10) + edge_name(b, k), dot(n, on_a - on_b), (on_a + on_b) * Real(0.5));
  }

  /// Ends of one edge beside the other, which is parallel.
  GONOGO_HD void ends(const Facet& of, const Facet& beside, int name, Real sign) {
    const Vec3 v = beside.point[1] - beside.point[0];
    for (int k = 0; k < 2; ++k) {
      const Real t = dot(of.point[k] - beside.point[0], v) / dot(v, v);
      if (t < Real(-1e-4) || t > Real(1.0001)) continue;
      const Vec3 foot = beside.point[0] + v * t;
      add(name + of.id[k], sign * dot(n, of.point[k] - foot), (of.point[k] + foot) * Real(0.5));
    }
  }

  GONOGO_HD bool parallel_edges() const {
    const Vec3 u = a.point[1] - a.point[0], v = b.point[1] - b.point[0], across = cross(u, v);
    return dot(across, across) < Real(0.01) * dot(u, u) * dot(v, v);
  }

  GONOGO_HD void run() {
    const bool edges = a.count == 2 && b.count == 2;
    if (edges && parallel_edges()) {
      ends(a, b, 256, 1);
      ends(b, a, 512, -1);
      return;
    }
    if (b.count > 2) corners(a, b, 256, 1);
    if (a.count > 2) corners(b, a, 512, -1);
    for (int i = 0; i < (a.count == 2 ? 1 : a.count); ++i)
      for (int k = 0; k < (b.count == 2 ? 1 : b.count); ++k) crossing(i, k, Real(1e-3));
  }
};

/// Calls visit(feature, touch) for the contacts of two bodies with gaps below the envelope; touch is owned by a.
template <class Visit>
GONOGO_HD inline void visit_convex_touches(const Convex& a, const Convex& b, Real envelope, Visit&& visit) {
  const bool smooth = is_strictly_convex(a) || is_strictly_convex(b);
  const Real scale = std::fmin(min_half(a), min_half(b)), handicap = smooth ? Real(0) : Real(1e-3) * scale;
  SeparationSearch search{a, b};
  search.consider_flats(b, 0);
  search.consider_flats(a, handicap);
  if (smooth) search.consider_centres();
  if (search.best.gap >= envelope) return;
  search.consider_edges(handicap);
  search.consider_nearest(scale, handicap);
  if (smooth) search.climb();
  const Separation s = search.best;
  if (s.gap >= envelope) return;
  const auto emit = [&](int feature, Real gap, const Vec3& middle) {
    if (gap < envelope) visit(feature, Touch{gap, s.normal, middle - a.centre});
  };
  const Facet fa = facet(a, -s.normal), fb = facet(b, s.normal);
  if (fa.count == 1 || fb.count == 1) {
    const bool of_a = smooth ? is_strictly_convex(a) : fa.count == 1;
    const Facet &corner = of_a ? fa : fb, &other = of_a ? fb : fa;
    const Real inward = of_a ? -s.gap / 2 : s.gap / 2;
    const bool beside = other.count > 2 && !in_facet(other, corner.point[0], s.normal, handicap);
    const Vec3 middle =
        !smooth && (search.by_nearest || beside) ? search.middle() : corner.point[0] + s.normal * inward;
    emit((of_a ? 256 : 512) + corner.id[0], s.gap, middle);
  } else {
    FacetPair<decltype(emit)> pair{fa, fb, s.normal, scale, emit};
    pair.run();
    // The facets miss the nearest points: the end of an edge beside another body, or facets at an angle.
    if (pair.least > s.gap + handicap) emit(0, s.gap, search.middle());
  }
}

}  // namespace gonogo::sim
