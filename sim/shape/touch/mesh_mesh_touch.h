// Two meshes: corners of either on faces, edges and corners of the other, and crossings of ridges. Both meshes are
// treated alike, so the order of the pair changes no contact. For the limits see solid_mesh_touch.h; here a point is
// pushed out from a depth of up to a quarter of the smaller mesh's smallest half extent.
//
// Where two meshes may touch: one tree of boxes against the other. Boxes are aligned with the axes of their mesh, so
// those of one mesh are oriented boxes for the other (Gottschalk, Lin, Manocha 1996). No touching triangles are left
// out.
#pragma once
#include "sim/shape/touch/mesh_feature.h"

namespace gonogo::sim {

/// Tests boxes of one mesh against the other's boxes, grown by the reach.
class MeshDescent {
 public:
  /// `reach`: max distance of interest [m].
  GONOGO_HD MeshDescent(const PlacedMesh& own, const PlacedMesh& other, Real reach)
      : other_(other.mesh), grown_(PlacedMesh::turned_half(conjugate(other.q), {reach, reach, reach})) {
    const Vec3 unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < 3; ++k) axis_[k] = rotate_back(other.q, rotate(own.q, unit[k]));
    shift_ = static_cast<Vec3>(in_frame(other.q, own.centre - other.centre));
  }

  /// Whether a box of the own mesh, along its axes, is within reach of a box of the other that is as small or a leaf.
  GONOGO_HD bool meets(const Vec3& low, const Vec3& high) const {
    const Vec3 half = (high - low) * Real(0.5), middle = (low + high) * Real(0.5);
    const Vec3 at = axis_[0] * middle.x + axis_[1] * middle.y + axis_[2] * middle.z + shift_;
    const Real size = largest(half);
    for (Index n = 0; n < other_.range.node_count;) {
      const MeshNode& node = other_.node[n];
      const Vec3 its = (node.high - node.low) * Real(0.5);
      if (are_apart(at - (node.low + node.high) * Real(0.5), half, its + grown_)) {
        n = node.skip;
        continue;
      }
      if (node.count > 0 || largest(its) <= size) return true;
      ++n;
    }
    return false;
  }

 private:
  const MeshSurface& other_;
  Vec3 grown_;    // by which half edges of the other mesh's boxes grow
  Vec3 axis_[3];  // of the own mesh, in the axes of the other
  Vec3 shift_;    // of the own origin, there

  GONOGO_HD static Real largest(const Vec3& v) { return std::fmax(v.x, std::fmax(v.y, v.z)); }

  /// Whether one of the 15 directions separates a box of the own mesh from one of the other. `d`: between their
  /// middles.
  GONOGO_HD bool are_apart(const Vec3& d, const Vec3& own, const Vec3& its) const {
    const Real h[3] = {own.x, own.y, own.z}, g[3] = {its.x, its.y, its.z}, at[3] = {d.x, d.y, d.z};
    // Rounding of the axes; where two are parallel, their cross product must not separate.
    constexpr Real more = Real(1e-5);
    const Real r[3][3] = {{axis_[0].x, axis_[1].x, axis_[2].x},
                          {axis_[0].y, axis_[1].y, axis_[2].y},
                          {axis_[0].z, axis_[1].z, axis_[2].z}};
    Real size[3][3];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) size[i][k] = std::fabs(r[i][k]) + more;
    for (int i = 0; i < 3; ++i)
      if (std::fabs(at[i]) > g[i] + h[0] * size[i][0] + h[1] * size[i][1] + h[2] * size[i][2]) return true;
    for (int k = 0; k < 3; ++k) {
      const Real along = at[0] * r[0][k] + at[1] * r[1][k] + at[2] * r[2][k];
      if (std::fabs(along) > h[k] + g[0] * size[0][k] + g[1] * size[1][k] + g[2] * size[2][k]) return true;
    }
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        const Real along = at[i2] * r[i1][k] - at[i1] * r[i2][k];
        const Real reach = g[i1] * size[i2][k] + g[i2] * size[i1][k] + h[k1] * size[i][k2] + h[k2] * size[i][k1];
        if (std::fabs(along) > reach) return true;
      }
    return false;
  }
};

/// A half angle.
struct Angle {
  Real cosine, sine;

  GONOGO_HD static Angle of_cosine(Real c) { return {c, std::sqrt(1 - c * c)}; }
  GONOGO_HD static Angle of_sine(Real s) { return {std::sqrt(1 - s * s), s}; }
  GONOGO_HD Angle operator+(const Angle& b) const {
    return {cosine * b.cosine - sine * b.sine, sine * b.cosine + cosine * b.sine};
  }
};

/// Selects the nodes of a mesh that a corner or edge of another one may touch. A face or ridge touches along one of its
/// normals, which may miss by kLean, so a node whose normals all point elsewhere is left out (normal cones: Johnson &
/// Cohen 2001).
class Facing {
 public:
  /// Of a corner, in world axes like all of `from`. Nodes within `near` [m] are always selected. Beside a valley the
  /// corner may lie on a face that it is not above (may_be_on).
  GONOGO_HD Facing(const MeshFrom& from, const Vec3& corner, Real near)
      : mesh_(from.surface.mesh), at_(place(from, corner)), near_(near) {}

  /// Of an edge, whose own normals must point to the other mesh too.
  GONOGO_HD Facing(const MeshFrom& from, const Edge& edge, Real near)
      : mesh_(from.surface.mesh),
        at_(place(from, edge.start + edge.along * Real(0.5))),
        near_(near + length(edge.along) * Real(0.5)),
        is_edge_(true) {
    // Square to the edge and away from both faces: between their normals, which are 90 degrees from the faces.
    const Vec3 out = -(edge.inward + edge.beyond);
    const Real size = length(out);
    if (size < Real(1e-3)) return;  // flat, or a slit: the sum has no direction
    out_ = rotate_back(from.surface.q, out * (1 / size));
    own_ = Angle::of_sine(std::fmin(Real(1), dot(out, -edge.inward) / size)) + Angle::of_sine(kLean);
  }

  GONOGO_HD bool wants(const MeshNode& node) const {
    const NormalCone& cone = mesh_.cone[&node - mesh_.node];
    const Vec3 half = (node.high - node.low) * Real(0.5), d = (node.low + node.high) * Real(0.5) - at_;
    const Real radius = length(half) + near_, square = dot(d, d);
    if (square <= radius * radius) return true;
    const Angle ball = Angle::of_sine(radius / std::sqrt(square));  // around the node, as the corner sees it
    if (is_edge_ && is_aside(own_ + ball, dot(d, out_), square)) return false;
    if (cone.cosine == 0 || (cone.cosine < 0 && !is_edge_)) return true;
    return !is_aside(Angle::of_cosine(std::fabs(cone.cosine)) + Angle::of_sine(kLean) + ball, dot(d, cone.axis),
                     square);
  }

 private:
  const MeshSurface& mesh_;
  Vec3 at_;  // as the next, in the mesh's axes
  Vec3 out_;
  Angle own_{0, 1};  // of the edge's normals about `out_`
  Real near_;
  bool is_edge_ = false;

  GONOGO_HD static Vec3 place(const MeshFrom& from, const Vec3& p) {
    return static_cast<Vec3>(in_frame(from.surface.q, static_cast<Vec3d>(p) + from.origin - from.surface.centre));
  }

  /// Whether a direction of length sqrt(square), `along` an axis, misses it and its opposite by more than `max`.
  GONOGO_HD static bool is_aside(const Angle& max, Real along, Real square) {
    const Real least = max.cosine - Real(1e-3);
    return least > 0 && along * along < least * least * square;
  }
};

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
