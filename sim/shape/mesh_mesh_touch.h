// Two meshes: corners of either on faces, edges and corners of the other, and crossings of ridges. Both meshes are
// treated alike, so the order of the pair changes no contact. For the limits see solid_mesh_touch.h; here a point is
// pushed out from a depth of up to a quarter of the smaller mesh's smallest half extent.
#pragma once
#include "sim/shape/mesh_descent.h"
#include "sim/shape/mesh_face.h"

namespace gonogo::sim {

template <class Visit>
struct MeshOnMesh {
  const MeshFrom &a, &b;
  Tolerance tol;
  Visit& visit;

  /// Corner k of triangle t of one mesh against the other one; `first`: the corner belongs to a.
  struct Corner {
    const MeshFrom &own, &other;
    bool first;
    Index t;
    int k;
    Vec3 p;
    GONOGO_HD bool supports(const Vec3& n, Real lean) const { return own.supports(t, k, n, lean); }
  };

  /// `n` leads out of the other mesh.
  GONOGO_HD void emit(const Corner& c, int feature, Real gap, const Vec3& n) {
    const auto own = std::uint32_t(c.own.surface.vertex(c.t, c.k));
    visit(feature_name(c.first ? 0 : 1, own, std::uint32_t(feature)),
          Touch{gap, c.first ? n : -n, c.p - n * (gap / 2)});
  }

  /// `gap`: over the plane of triangle t, whose normal is `n`.
  GONOGO_HD void on_face(const Corner& c, Index t, const Vec3& n, Real gap) {
    if (!may_be_on(c.other, t, n, c.p, gap, tol)) return;
    const auto supports = [&](const Vec3& direction, Real lean) { return c.supports(direction, lean); };
    if (c.supports(-n, kLean) && leads_out(c.other, WayOut{t, centroid(c.other, t), c.p, gap}, tol, supports))
      emit(c, c.other.name(t, 0), gap, n);
  }

  /// Apart from the other mesh, nearest to an edge or corner. Two corners are met from a.
  GONOGO_HD void beside(const Corner& c, Index t) {
    const Vec3 u = c.other.corner(t, 0) - c.p, v = c.other.corner(t, 1) - c.p, w = c.other.corner(t, 2) - c.p;
    const OnTriangle on = nearest_on_triangle(u, v, w);
    if (on.feature == 0 || (on.feature > 3 && !c.first)) return;
    const Real gap = length(on.point);
    if (gap <= tol.slack || gap >= tol.envelope || !c.other.is_local_minimum(t, on.feature, -on.point)) return;
    const Vec3 n = on.point * (-1 / gap);
    if (dot(n, c.other.outward(t, on.feature)) > 0 && c.supports(-n, kLean))
      emit(c, c.other.name(t, on.feature), gap, n);
  }

  GONOGO_HD void corner(const Corner& c) {
    const Real reach = std::fmax(tol.envelope, tol.limit);
    const Vec3 box{reach, reach, reach};
    const Facing facing(c.other, c.p, tol.envelope + tol.slack);
    c.other.surface.visit_facing(c.p - box, c.p + box, facing, [&](Index t) {
      const Vec3 n = c.other.normal(t);
      const Real gap = dot(c.p - c.other.corner(t, 0), n);
      on_face(c, t, n, gap);
      if (std::fabs(gap) < tol.envelope + tol.slack) beside(c, t);
    });
  }

  GONOGO_HD void crossing(const Edge& of_a, const Edge& of_b, Index name_a, Index name_b) {
    Crossing c;
    if (!edges_cross(of_a, of_b, tol, c)) return;
    if (c.gap < -tol.slack) {
      const WayOut from_a{-1, of_a.start + of_a.along * Real(0.5), c.on_b, c.gap};
      const WayOut from_b{-1, of_b.start + of_b.along * Real(0.5), c.on_a, c.gap};
      if (!leads_out(a, from_a, tol, [&](const Vec3& n, Real lean) { return of_b.supports(n, lean); }) ||
          !leads_out(b, from_b, tol, [&](const Vec3& n, Real lean) { return of_a.supports(n, lean); }))
        return;
    }
    visit(feature_name(2, std::uint32_t(name_a), std::uint32_t(name_b)),
          Touch{c.gap, c.normal, (c.on_a + c.on_b) * Real(0.5)});
  }

  GONOGO_HD void ridge(Index t, int k) {
    const Edge of_a = mesh_edge(a, t, k);
    const Vec3 p = of_a.start, q = of_a.start + of_a.along;
    const Real reach = std::fmax(tol.envelope, tol.limit);
    const Vec3 low{std::fmin(p.x, q.x) - reach, std::fmin(p.y, q.y) - reach, std::fmin(p.z, q.z) - reach};
    const Vec3 high{std::fmax(p.x, q.x) + reach, std::fmax(p.y, q.y) + reach, std::fmax(p.z, q.z) + reach};
    const Facing facing(b, of_a, 2 * tol.slack);
    b.surface.visit_facing(low, high, facing, [&](Index s) {
      for (int i = 0; i < 3; ++i)
        if (b.surface.has(MeshMark::ridge, s, i)) crossing(of_a, mesh_edge(b, s, i), 3 * t + k, 3 * s + i);
    });
  }

  /// The parts of one mesh near the other.
  GONOGO_HD void look(const MeshFrom& own, const MeshFrom& other, bool first) {
    const MeshDescent descent(own.surface, other.surface, std::fmax(tol.envelope, tol.limit) + tol.slack);
    const auto wanted = [&](const MeshNode& node) { return descent.meets(node.low, node.high); };
    own.surface.mesh.visit_where(wanted, [&](Index t) {
      for (int k = 0; k < 3; ++k) {
        if (own.surface.has(MeshMark::sharp, t, k)) corner({own, other, first, t, k, own.corner(t, k)});
        if (first && own.surface.has(MeshMark::ridge, t, k)) ridge(t, k);
      }
    });
  }

  GONOGO_HD void run() {
    look(a, b, true);
    look(b, a, false);
  }
};

}  // namespace gonogo::sim
