// Boxes, cylinders and the parts of wheels on meshes. Contacts are
//   - corners, ends of sides and rims of the solid on faces of the mesh (its facets: see convex.h),
//   - corners of the mesh on the solid, by the solid's signed distance,
//   - crossings of the mesh's ridges with edges, rims and sides of the solid.
// Together they span the polygon that a convex body and a face of the mesh share. On a mesh of a convex body they are
// the contacts of the two bodies. Limits:
//   - Edges parallel within 2 degrees, neither on a face of the other body, have no contact until a corner has one.
//   - A point deeper than half of the solid's smallest half extent is not pushed out.
//   - A body that is deeper in a wall than the wall is thick may be pushed out on the other side.
//
// Ellipsoids on meshes: the furthest point on faces, corners of the mesh, and its ridges. An ellipsoid has one furthest
// point in each direction, so a flat face has one contact for any triangulation, and edges inside of it have none.
#pragma once
#include "sim/shape/touch/mesh_feature.h"

namespace gonogo::sim {

template <class Visit>
struct SolidOnMesh {
  const MeshFrom& from;
  const Convex& solid;
  int part;     // of a wheel, whose centre is the origin
  Real hidden;  // points of a lug nearer to the axle than this lie inside the wheel [m]
  Tolerance tol;
  Visit& visit;

  enum Kind { face, corner, edge, beside };

  GONOGO_HD bool is_hidden(const Vec3& p) const {
    const Real along = dot(p, solid.axis[1]);
    return dot(p, p) - along * along < hidden * hidden;
  }

  GONOGO_HD void emit(Kind kind, int of_solid, int of_mesh, Real gap, const Vec3& n, const Vec3& middle) {
    if (part > 0 && is_hidden(middle + n * (gap / 2))) return;
    visit(feature_name(kind, std::uint32_t(64 * part + of_solid), std::uint32_t(of_mesh)), Touch{gap, n, middle});
  }

  GONOGO_HD bool pressed(const Vec3& p, const Vec3& direction, Real lean) const {
    return point_supports(solid, p, direction, tol.slack, lean);
  }

  /// Points of the solid on a face.
  GONOGO_HD void on_face(Index t) {
    const Vec3 n = from.normal(t), base = from.corner(t, 0);
    const Real low = dot(solid.centre - base, n) - extent(solid, n);
    if (low >= tol.envelope || low < -tol.limit) return;
    const Facet f = facet(solid, -n);
    for (int k = 0; k < f.count; ++k) {
      const Vec3 p = f.point[k];
      const Real gap = dot(p - base, n);
      if (!may_be_on(from, t, n, p, gap, tol)) continue;
      const auto supports = [&](const Vec3& direction, Real lean) { return pressed(p, direction, lean); };
      if (leads_out(from, WayOut{t, centroid(from, t), p, gap}, tol, supports))
        emit(face, f.id[k], int(from.surface.name(t)), gap, n, p - n * (gap / 2));
    }
  }

  /// A corner of the mesh. Near the solid's surface and inside of it, it leaves by the nearest side that it presses on.
  GONOGO_HD void on_solid(Index t, int k) {
    const Vec3 p = from.corner(t, k);
    const Sides sides = sides_at(solid, p);
    Vec3 apart, out;
    Real gap = -tol.limit;
    bool found = false;
    for (int i = 0; i < sides.count; ++i) {
      if (sides.gap[i] >= tol.envelope) return;
      if (sides.gap[i] > tol.slack) apart += sides.normal[i] * sides.gap[i];
    }
    if (const Real distance = length(apart); distance > 0) {
      gap = distance;
      out = apart * (1 / distance);
      found = gap < tol.envelope && from.supports(t, k, -out, kLean);
    } else {
      for (int i = 0; i < sides.count; ++i)
        if (sides.gap[i] > gap && from.supports(t, k, -sides.normal[i], kLean)) {
          gap = sides.gap[i];
          out = sides.normal[i];
          found = true;
        }
    }
    if (found) emit(corner, 0, int(from.surface.vertex(t, k)), gap, -out, p - out * (gap / 2));
  }

  GONOGO_HD void crossing(const Edge& own, const Edge& ridge, const Crossing& c, int of_solid, int of_mesh) {
    const auto supports = [&](const Vec3& direction, Real lean) { return own.supports(direction, lean); };
    if (c.gap < -tol.slack) {
      if (leaves_sooner(solid, ridge, c.on_b, c.gap, tol.slack)) return;
      const WayOut way{-1, ridge.start + ridge.along * Real(0.5), c.on_a, c.gap};
      if (!leads_out(from, way, tol, supports)) return;
    }
    emit(edge, of_solid, of_mesh, c.gap, c.normal, (c.on_a + c.on_b) * Real(0.5));
  }

  /// Whether a point with these coordinates (in the box's axes) may be within `reach` of an edge or corner at `side`
  /// times the half edges. A side of 0: the edge runs along that axis.
  GONOGO_HD bool is_near(const Vec3& x, const Vec3& side, Real reach) const {
    const auto near = [&](Real at, Real half, Real s) {
      return s == 0 ? std::fabs(at) <= half + reach : std::fabs(at - s * half) <= reach;
    };
    return near(x.x, solid.size.x, side.x) && near(x.y, solid.size.y, side.y) && near(x.z, solid.size.z, side.z);
  }

  GONOGO_HD void box_edge(const Edge& ridge, const Vec3& middle, int i, int of_mesh) {
    const int u = i / 4, v = (u + 1) % 3, w = (u + 2) % 3;
    const Real half[3] = {solid.size.x, solid.size.y, solid.size.z};
    Real side[3] = {};
    side[v] = i & 1 ? Real(1) : Real(-1);
    side[w] = i & 2 ? Real(1) : Real(-1);
    const Real reach = Real(0.5) * length(ridge.along) + std::fmax(tol.envelope, tol.limit);
    if (!is_near(middle, {side[0], side[1], side[2]}, reach)) return;
    const Vec3 along = solid.axis[u] * half[u], out_v = solid.axis[v] * side[v], out_w = solid.axis[w] * side[w];
    const Edge own{solid.centre - along + out_v * half[v] + out_w * half[w], along * Real(2), -out_v, -out_w};
    Crossing c;
    if (edges_cross(own, ridge, tol, c)) crossing(own, ridge, c, i, of_mesh);
  }

  /// A corner of a box apart from a ridge, nearest to it between the ridge's ends.
  GONOGO_HD void beside_ridge(const Edge& ridge, const Vec3& middle, int i, int of_mesh) {
    const Vec3 side{i & 1 ? Real(1) : Real(-1), i & 2 ? Real(1) : Real(-1), i & 4 ? Real(1) : Real(-1)};
    if (!is_near(middle, side, Real(0.5) * length(ridge.along) + tol.envelope)) return;
    const Vec3 p = solid.centre + solid.out_of(scale(side, solid.size));
    const Real at = dot(p - ridge.start, ridge.along) / dot(ridge.along, ridge.along);
    if (at <= 0 || at >= 1) return;
    const Vec3 d = p - (ridge.start + ridge.along * at);
    const Real gap = length(d), max = Real(1e-4) * gap;
    if (gap <= tol.slack || gap >= tol.envelope || dot(d, ridge.inward) > max || dot(d, ridge.beyond) > max) return;
    const Vec3 n = d * (1 / gap);
    if (pressed(p, -n, kLean)) emit(beside, i, of_mesh, gap, n, p - d * Real(0.5));
  }

  /// The line along a cylinder's side that is nearest to the ridge's line.
  GONOGO_HD void across_side(const Edge& ridge, int of_mesh) {
    const Vec3& axis = solid.axis[1];
    Vec3 out = cross(ridge.along, axis);
    const Real size = length(out);
    if (size < Real(0.03) * length(ridge.along)) return;
    out = out * ((dot(out, ridge.start - solid.centre) < 0 ? Real(-1) : Real(1)) / size);
    const Vec3 tangent = cross(axis, out), along = axis * (2 * solid.size.y);
    const Edge own{solid.centre + out * solid.size.x - along * Real(0.5), along, tangent, -tangent};
    Crossing c;
    if (edges_cross(own, ridge, tol, c)) crossing(own, ridge, c, 16, of_mesh);
  }

  /// Tangent of a rim beside a point.
  GONOGO_HD Edge rim_beside(const Vec3& p, int cap) const {
    const Vec3 x = solid.into(p - solid.centre), top = solid.axis[1] * (cap == 0 ? Real(-1) : Real(1));
    const Real r = std::fmax(std::sqrt(x.x * x.x + x.z * x.z), Real(1e-3) * solid.size.x);
    const Vec3 out = solid.out_of({x.x / r, 0, x.z / r});
    return {solid.centre + out * solid.size.x + top * solid.size.y, cross(top, out) * solid.size.x, -out, -top};
  }

  /// A ridge crosses a rim where it crosses the rim's tangent. `at`: first guess along the ridge, a point level with
  /// the rim or at its distance from the axis. If two guesses lead to one place, the one that suits the normal counts.
  GONOGO_HD void at_rim(const Edge& ridge, Real at, int cap, bool level, int of_solid, int of_mesh) {
    if (!(at >= Real(-0.5) && at <= Real(1.5))) return;
    Crossing c;
    Real s = 0;
    Edge rim = rim_beside(ridge.start + ridge.along * at, cap);
    for (int i = 0; i < 4; ++i) {
      if (!lines_cross(rim, ridge, c, s, at) || std::fabs(s) > 1) return;
      if (i < 3) rim = rim_beside(c.on_a, cap);
    }
    if (level != (std::fabs(dot(c.normal, rim.inward)) > std::fabs(dot(c.normal, rim.beyond)))) return;
    if (is_between_ends(ridge, at, tol.slack) && may_touch(rim, ridge, c, tol))
      crossing(rim, ridge, c, of_solid, of_mesh);
  }

  GONOGO_HD void rims(const Edge& ridge, int of_mesh) {
    const Vec3 s = solid.into(ridge.start - solid.centre), u = solid.into(ridge.along);
    const Real a = u.x * u.x + u.z * u.z, b = s.x * u.x + s.z * u.z;
    const Real root = b * b - a * (s.x * s.x + s.z * s.z - solid.size.x * solid.size.x);
    for (int cap = 0; cap < 2; ++cap) {
      if (std::fabs(u.y) > 0)
        at_rim(ridge, ((cap == 0 ? -solid.size.y : solid.size.y) - s.y) / u.y, cap, true, 17 + cap, of_mesh);
      if (!(root >= 0 && a > 0)) continue;
      at_rim(ridge, (-b - std::sqrt(root)) / a, cap, false, 19 + cap, of_mesh);
      at_rim(ridge, (-b + std::sqrt(root)) / a, cap, false, 21 + cap, of_mesh);
    }
  }

  GONOGO_HD void on_ridge(Index t, int k) {
    const Edge ridge = mesh_edge(from, t, k);
    const int name = int(3 * t + k);
    if (solid.type == ShapeType::box) {
      const Vec3 middle = solid.into(ridge.start + ridge.along * Real(0.5) - solid.centre);
      for (int i = 0; i < 12; ++i) box_edge(ridge, middle, i, name);
      for (int i = 0; i < 8; ++i) beside_ridge(ridge, middle, i, name);
    } else {
      across_side(ridge, name);
      rims(ridge, name);
    }
  }

  GONOGO_HD void run() {
    const Vec3 half = Vec3{extent(solid, {1, 0, 0}), extent(solid, {0, 1, 0}), extent(solid, {0, 0, 1})} +
                      Vec3{tol.envelope, tol.envelope, tol.envelope};
    from.surface.visit_near(solid.centre - half, solid.centre + half, [&](Index t) {
      on_face(t);
      for (int k = 0; k < 3; ++k) {
        if (from.surface.has(MeshMark::sharp, t, k)) on_solid(t, k);
        if (from.surface.has(MeshMark::ridge, t, k)) on_ridge(t, k);
      }
    });
  }
};

/// Calls visit(feature, touch) for the contacts of a part of a solid. The solid owns the touch, whose point is relative
/// to the origin of `from`.
template <class Visit>
GONOGO_HD inline void visit_solid_mesh_touches(const MeshFrom& from, const Convex& solid, int part, Real hidden,
                                               const Tolerance& tol, Visit&& visit) {
  SolidOnMesh<Visit>{from, solid, part, hidden, tol, visit}.run();
}

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
