// Where a point of another body leaves a mesh: through the faces below it that the body presses on. Beside a convex
// edge that is the face with the smallest overlap; in a hollow it is every face.
#pragma once
#include "sim/shape/mesh_feature.h"

namespace gonogo::sim {

/// Tolerances of contacts with meshes [m].
struct Tolerance {
  Real envelope;  // contacts are found up to this gap
  Real slack;     // 1e-4 of the smaller body: shorter lengths may be rounding
  Real limit;     // deeper points are ignored
};

/// `half`: half of the smallest side of the smaller body; `share`: limit / half.
GONOGO_HD inline Tolerance tolerance_for(Real half, Real share, Real envelope) {
  return {envelope, Real(1e-4) * half, std::fmax(share * half, envelope)};
}

/// Whether the foot of a point lies in triangle t, whose normal is `n`, or beyond a valley's edge by up to `hollow`.
GONOGO_HD inline bool is_over(const MeshFrom& from, Index t, const Vec3& n, const Vec3& p, Real slack, Real hollow) {
  for (int k = 0; k < 3; ++k) {
    const Vec3 start = from.corner(t, k), edge = from.corner(t, (k + 1) % 3) - start;
    const Real reach = from.surface.has(MeshMark::valley, t, k) ? hollow : slack;
    if (dot(cross(n, edge), p - start) < -reach * length(edge)) return false;
  }
  return true;
}

/// The same for a point that may lie a few envelopes, or as deep as in this face, in the other wall of a hollow.
GONOGO_HD inline bool may_be_on(const MeshFrom& from, Index t, const Vec3& n, const Vec3& p, Real gap,
                                const Tolerance& tol) {
  if (gap >= tol.envelope || gap < -tol.limit) return false;
  return is_over(from, t, n, p, tol.slack, 4 * std::fmax(tol.envelope, -gap));
}

GONOGO_HD inline Vec3 centroid(const MeshFrom& from, Index t) {
  return (from.corner(t, 0) + from.corner(t, 1) + from.corner(t, 2)) * Real(1.0 / 3);
}

/// Distance [m] by which a point of a leaning body may lie outside of a face in which it is `-gap` deep.
GONOGO_HD inline Real off_surface(Real gap, Real slack) {
  return slack + std::fmin(-kLean * std::fmin(gap, Real(0)), 50 * slack);
}

/// A point that may have entered a mesh by `-gap` through a feature with the given middle: triangle `t`, or a ridge if
/// t is negative.
struct WayOut {
  Index t;
  Vec3 middle;
  Vec3 p;
  Real gap;
};

/// Whether another way out is preferred to one of length `gap`: it is shorter, and clearly shorter where the body only
/// leans on it.
template <class Supports>
GONOGO_HD inline bool goes_before(Real other, Real gap, Real slack, Supports&& supports) {
  if (other < gap + slack) return false;
  return supports(other > Real(0.7) * gap ? kLean : kStrict);
}

/// The triangle of a mesh that is nearest to a point, of those offered.
struct NearestTriangle {
  Index t = -1;
  OnTriangle on{};
  Real distance = Real(1e30);

  GONOGO_HD void offer(const MeshFrom& from, const Vec3& p, Index triangle) {
    const Vec3 a = from.corner(triangle, 0) - p, b = from.corner(triangle, 1) - p, c = from.corner(triangle, 2) - p;
    const OnTriangle here = nearest_on_triangle(a, b, c);
    const Real apart = length(here.point);
    if (!(apart < distance)) return;
    distance = apart;
    t = triangle;
    on = here;
  }
};

/// Whether the point leaves the solid there: it is inside, no other face beside a convex edge is a shorter way out, and
/// this is the first triangle of a flat face. supports(n, lean): whether the other body's point may press along n.
template <class Supports>
GONOGO_HD inline bool leads_out(const MeshFrom& from, const WayOut& way, const Tolerance& tol, Supports&& supports) {
  const bool deep = way.gap < -tol.slack;
  const Real reach = (deep ? -way.gap : Real(0)) + 2 * tol.slack;
  const Real beside = off_surface(way.gap, tol.slack);
  // A ridge lies in both of its faces, so they are no other way out.
  const Real below = way.t >= 0 ? Real(0) : -tol.slack;
  const Real wide = 10 * tol.slack;  // at acute corners a point is further from a triangle than from its edges
  const Vec3 box{reach, reach, reach};
  // Above a flat face the foot selects the triangle: the point itself may be an envelope away from all of them.
  const Vec3 at = way.t >= 0 && !deep ? way.p - from.normal(way.t) * way.gap : way.p;
  bool out = true;
  NearestTriangle nearest;
  from.surface.visit_near(at - box, at + box, [&](Index t) {
    if (!out) return;
    if (deep) nearest.offer(from, way.p, t);
    if (t == way.t) return;
    const bool same_face = way.t >= 0 && from.surface.name(t) == from.surface.name(way.t);
    if (same_face ? t > way.t : !deep) return;
    const Vec3 n = from.normal(t), base = from.corner(t, 0);
    if (same_face) {
      out = !is_over(from, t, n, way.p, tol.slack, tol.slack);
      return;
    }
    const Real gap = dot(way.p - base, n);
    if (gap > beside || dot(way.middle - base, n) >= below) return;
    if (goes_before(gap, way.gap, tol.slack, [&](Real lean) { return supports(-n, lean); }))
      out = !is_over(from, t, n, way.p, wide, wide);
  });
  if (!out || !deep) return out;
  return nearest.t >= 0 &&
         (nearest.distance < beside || dot(nearest.on.point, from.outward(nearest.t, nearest.on.feature)) > 0);
}

/// Whether a ridge of a mesh, whose point `p` is `-gap` deep in a box or cylinder, would leave it sooner through one of
/// its sides.
GONOGO_HD inline bool leaves_sooner(const Convex& solid, const Edge& ridge, const Vec3& p, Real gap, Real slack) {
  const Sides sides = sides_at(solid, p);
  bool sooner = false;
  for (int k = 0; k < sides.count; ++k) {
    if (sides.gap[k] > off_surface(gap, slack)) return false;
    const auto supports = [&](Real lean) { return ridge.supports(-sides.normal[k], lean); };
    sooner = sooner || goes_before(sides.gap[k], gap, slack, supports);
  }
  return sooner;
}

/// Where two edges cross, seen along the normal, which leads from b to a.
struct Crossing {
  Vec3 normal, on_a, on_b;
  Real gap;
};

/// Where the lines of two edges cross; false if they are parallel within 2 degrees. `s`, `t`: along a and b, 0 .. 1
/// between the ends.
GONOGO_HD inline bool lines_cross(const Edge& a, const Edge& b, Crossing& c, Real& s, Real& t) {
  const Vec3 square = cross(a.along, b.along);
  const Real size = length(square);
  if (size < Real(0.03) * length(a.along) * length(b.along)) return false;
  c.normal = square * ((dot(square, b.inward + b.beyond) > 0 ? Real(-1) : Real(1)) / size);
  const Vec3 w = b.start - a.start;
  const Real area = dot(square, c.normal);
  s = dot(cross(w, b.along), c.normal) / area;
  t = dot(cross(w, a.along), c.normal) / area;
  c.on_a = a.start + a.along * s;
  c.on_b = b.start + b.along * t;
  c.gap = dot(c.normal, c.on_a - c.on_b);
  return true;
}

/// Whether two crossing edges face each other and are near enough to touch.
GONOGO_HD inline bool may_touch(const Edge& a, const Edge& b, const Crossing& c, const Tolerance& tol) {
  return c.gap < tol.envelope && c.gap > -tol.limit && b.is_outer(c.normal, kLean) && a.is_outer(-c.normal, kLean);
}

GONOGO_HD inline bool is_between_ends(const Edge& e, Real at, Real slack) {
  const Real end = slack / length(e.along);
  return at >= -end && at <= 1 + end;
}

GONOGO_HD inline bool edges_cross(const Edge& a, const Edge& b, const Tolerance& tol, Crossing& c) {
  Real s = 0, t = 0;
  return lines_cross(a, b, c, s, t) && is_between_ends(a, s, tol.slack) && is_between_ends(b, t, tol.slack) &&
         may_touch(a, b, c, tol);
}

}  // namespace gonogo::sim
