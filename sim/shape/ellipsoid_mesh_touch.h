// Ellipsoids on meshes: the furthest point on faces, corners of the mesh, and its ridges. An ellipsoid has one furthest
// point in each direction, so a flat face has one contact for any triangulation, and edges inside of it have none. For
// the limits see solid_mesh_touch.h.
#pragma once
#include "sim/shape/mesh_face.h"

namespace gonogo::sim {

template <class Visit>
struct EllipsoidOnMesh {
  const MeshFrom& from;
  const Convex& body;
  Tolerance tol;
  Visit& visit;

  enum Kind { face, corner, edge };

  /// `n`: unit, from the mesh to the body.
  GONOGO_HD void emit(Kind kind, int of_mesh, Real gap, const Vec3& n, const Vec3& middle) {
    visit(feature_name(kind, 0, std::uint32_t(of_mesh)), Touch{gap, n, middle});
  }

  /// Signed distance of a point from the body, and the normal of the body that leads to it.
  GONOGO_HD Gap gap_of(const Vec3& p) const {
    const Gap g = sphere_ellipsoid_gap(body.into(p - body.centre), body.size, 0);
    return {g.gap, body.out_of(g.normal)};
  }

  GONOGO_HD void on_face(Index t) {
    const Vec3 n = from.normal(t), base = from.corner(t, 0);
    const Vec3 p = body.centre + body.out_of(ellipsoid_support(body.size, body.into(-n)));
    const Real gap = dot(p - base, n);
    if (!may_be_on(from, t, n, p, gap, tol)) return;
    const auto supports = [&](const Vec3& direction, Real lean) {
      return dot(direction, n) < 0 && length(cross(direction, n)) <= lean;
    };
    if (leads_out(from, WayOut{t, centroid(from, t), p, gap}, tol, supports))
      emit(face, int(from.surface.name(t)), gap, n, p - n * (gap / 2));
  }

  GONOGO_HD void on_corner(Index t, int k) {
    const Vec3 p = from.corner(t, k);
    const Gap g = gap_of(p);
    if (g.gap >= tol.envelope || g.gap < -tol.limit || !from.supports(t, k, -g.normal, kStrict)) return;
    emit(corner, int(from.surface.vertex(t, k)), g.gap, -g.normal, p - g.normal * (g.gap / 2));
  }

  /// Point of the ridge nearest to the body or deepest in it, 0 .. 1 between the ends; -1: that is an end. The distance
  /// to a convex body is convex along the ridge, so its slope, the normal's component along the ridge, has one root. It
  /// is found by false position with the Illinois rule.
  GONOGO_HD_OUTLINED Real nearest_along(const Edge& ridge) const {
    const auto slope_at = [&](Real x) { return dot(gap_of(ridge.start + ridge.along * x).normal, ridge.along); };
    Real low = 0, high = 1, at_low = slope_at(0), at_high = slope_at(1), x = -1;
    if (at_low >= 0 || at_high <= 0) return -1;
    int stayed = 0;  // above zero: the high end, below: the low one
    for (int i = 0; i < 40; ++i) {
      x = low - at_low * (high - low) / (at_high - at_low);
      const Real slope = slope_at(x);
      if (std::fabs(slope) < Real(1e-5) * length(ridge.along) || high - low < Real(1e-6)) return x;
      if (slope < 0) {
        low = x;
        at_low = slope;
        if (stayed > 0) at_high *= Real(0.5);
        stayed = 1;
      } else {
        high = x;
        at_high = slope;
        if (stayed < 0) at_low *= Real(0.5);
        stayed = -1;
      }
    }
    return x;
  }

  GONOGO_HD void on_ridge(Index t, int k) {
    const Edge ridge = mesh_edge(from, t, k);
    const Vec3 middle = ridge.start + ridge.along * Real(0.5);
    if (length(middle - body.centre) > Real(0.5) * length(ridge.along) + reach()) return;
    const Real at = nearest_along(ridge);
    if (at < 0) return;  // a corner is nearer
    const Vec3 p = ridge.start + ridge.along * at;
    const Gap g = gap_of(p);
    if (g.gap >= tol.envelope || g.gap < -tol.limit || !ridge.is_outer(-g.normal, kStrict)) return;
    emit(edge, int(3 * t + k), g.gap, -g.normal, p - g.normal * (g.gap / 2));
  }

  GONOGO_HD Real reach() const { return std::fmax(body.size.x, std::fmax(body.size.y, body.size.z)) + tol.envelope; }

  GONOGO_HD void run() {
    const Vec3 more{tol.envelope, tol.envelope, tol.envelope};
    const Vec3 half = Vec3{extent(body, {1, 0, 0}), extent(body, {0, 1, 0}), extent(body, {0, 0, 1})} + more;
    from.surface.visit_near(body.centre - half, body.centre + half, [&](Index t) {
      on_face(t);
      for (int k = 0; k < 3; ++k) {
        if (from.surface.has(MeshMark::sharp, t, k)) on_corner(t, k);
        if (from.surface.has(MeshMark::ridge, t, k)) on_ridge(t, k);
      }
    });
  }
};

/// Calls visit(feature, touch) for the contacts of an ellipsoid. It owns the touch, whose point is relative to the
/// origin of `from`.
template <class Visit>
GONOGO_HD inline void visit_ellipsoid_mesh_touches(const MeshFrom& from, const Convex& body, const Tolerance& tol,
                                                   Visit&& visit) {
  EllipsoidOnMesh<Visit>{from, body, tol, visit}.run();
}

}  // namespace gonogo::sim
