// Spheres and capsules on surfaces of triangles. A triangle's nearest point is a contact only where the distance to the
// whole surface has a local minimum, that is where no neighbour has a nearer point. So a sphere on a flat floor has one
// contact for any triangulation, and on a ridge one with the ridge.
#pragma once
#include "sim/shape/surface.h"
#include "sim/shape/touch.h"

namespace gonogo::sim {

/// Nearest point of a triangle to the origin. feature: 0 face, 1 + k the edge from corner k, 4 + k the corner.
struct OnTriangle {
  Vec3 point;
  int feature;
};

/// Ericson, Real-Time Collision Detection (2005), 5.1.5, with the point at the origin.
GONOGO_HD inline OnTriangle nearest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Real d1 = -dot(ab, a), d2 = -dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return {a, 4};
  const Real d3 = -dot(ab, b), d4 = -dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return {b, 5};
  const Real vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), 1};
  const Real d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return {c, 6};
  const Real vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), 3};
  const Real va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), 2};
  const Vec3 n = cross(ab, ac);
  return {n * (dot(a, n) / dot(n, n)), 0};  // foot of the perpendicular: exact where weights of corners would cancel
}

/// A surface seen from a point: positions are relative to it, so that a float resolves the gap.
template <class Surface>
struct SurfaceFrom {
  const Surface& surface;
  Vec3d origin;

  GONOGO_HD Vec3 corner(Index t, int k) const { return at(surface.vertex(t, k)); }
  GONOGO_HD Vec3 at(Index vertex) const { return static_cast<Vec3>(surface.place(vertex) - origin); }

  GONOGO_HD Vec3 normal(Index t) const {
    const Vec3 a = corner(t, 0), n = cross(corner(t, 1) - a, corner(t, 2) - a);
    return n * (1 / length(n));
  }

  GONOGO_HD OnTriangle nearest(Index t) const { return nearest_on_triangle(corner(t, 0), corner(t, 1), corner(t, 2)); }

  /// From the edge of `t` after corner k into the triangle across it, square to the edge; zero at a rim.
  GONOGO_HD Vec3 across(Index t, int k) const {
    const Index other = surface.neighbour(t, k);
    if (other < 0) return {};
    const Vec3 from = corner(t, k), edge = corner(t, (k + 1) % 3) - from;
    Index far = 0;
    for (int i = 0; i < 3; ++i) {
      const Index v = surface.vertex(other, i);
      if (v != surface.vertex(t, k) && v != surface.vertex(t, (k + 1) % 3)) far = v;
    }
    const Vec3 in = at(far) - from;
    return in - edge * (dot(in, edge) / dot(edge, edge));
  }

  /// Sum of the normals beside the edge, which points outward.
  GONOGO_HD Vec3 edge_normal(Index t, int k) const {
    const Index other = surface.neighbour(t, k);
    return other < 0 ? normal(t) : normal(t) + normal(other);
  }

  GONOGO_HD int corner_of(Index t, Index vertex) const {
    return surface.vertex(t, 0) == vertex ? 0 : surface.vertex(t, 1) == vertex ? 1 : 2;
  }

  /// Calls visit(triangle, its corner) for the triangles around corner k of `t`, starting there.
  template <class Visit>
  GONOGO_HD void visit_ring(Index t, int k, Visit&& visit) const {
    const Index vertex = surface.vertex(t, k);
    visit(t, k);
    for (int way = 0; way < 2; ++way) {  // one way round; at a rim also the other way from the start
      Index now = t;
      for (int steps = 0; steps < 1000; ++steps) {
        const int c = corner_of(now, vertex);
        now = surface.neighbour(now, way == 0 ? (c + 2) % 3 : c);
        if (now == t) return;
        if (now < 0) break;
        visit(now, corner_of(now, vertex));
      }
    }
  }

  /// Sum of the normals around a corner, weighted by their angles, which decides inside or outside (Baerentzen & Aanaes
  /// 2005).
  GONOGO_HD Vec3 corner_normal(Index t, int k) const {
    Vec3 sum;
    visit_ring(t, k, [&](Index r, int c) {
      const Vec3 here = corner(r, c), u = corner(r, (c + 1) % 3) - here, v = corner(r, (c + 2) % 3) - here;
      const Real cosine = dot(u, v) / (length(u) * length(v));
      sum += normal(r) * std::acos(std::fmin(std::fmax(cosine, Real(-1)), Real(1)));
    });
    return sum;
  }

  GONOGO_HD Vec3 outward(Index t, int feature) const {
    return feature == 0 ? normal(t) : feature < 4 ? edge_normal(t, feature - 1) : corner_normal(t, feature - 4);
  }

  static constexpr Real kSlack = Real(1e-4);  // sine of an angle: rounding must not drop both of two neighbours

  /// Whether the distance has a local minimum at an edge or corner, met from this triangle first. `d`: from there to
  /// the point.
  GONOGO_HD bool is_local_minimum(Index t, int feature, const Vec3& d) const {
    if (feature == 0) return true;
    const Real size = length(d);
    if (feature < 4) {
      const Index other = surface.neighbour(t, feature - 1);
      const Vec3 in = across(t, feature - 1);
      return (other < 0 || t < other) && dot(d, in) <= kSlack * size * length(in);
    }
    bool first = true, minimum = true;
    visit_ring(t, feature - 4, [&](Index r, int c) {
      first = first && r >= t;
      for (int k = 1; k < 3; ++k) {
        const Vec3 edge = corner(r, (c + k) % 3) - corner(r, c);
        minimum = minimum && dot(d, edge) <= kSlack * size * length(edge);
      }
    });
    return first && minimum;
  }

  /// Names of contacts: 8 per triangle.
  GONOGO_HD int name(Index t, int feature) const { return feature == 0 ? 8 * surface.name(t) : 8 * t + feature; }
};

/// A sphere about the origin of `from` whose centre is outside of a solid or above ground. Calls visit(feature, touch)
/// in the surface's axes.
template <class Surface, class Visit>
GONOGO_HD inline void visit_outer_touches(const SurfaceFrom<Surface>& from, Real radius, Real envelope, Visit&& visit) {
  const auto p = static_cast<Vec3>(from.origin);
  const Real reach = radius + envelope;
  const Vec3 box{reach, reach, reach};
  from.surface.visit_near(p - box, p + box, [&](Index t) {
    const OnTriangle on = from.nearest(t);
    const Vec3 d = -on.point;
    const Real distance = length(d);
    if (distance >= reach || !from.is_local_minimum(t, on.feature, d)) return;
    const Vec3 out = from.outward(t, on.feature);
    if (dot(d, out) < 0) return;
    const bool flat = on.feature == 0 || distance < Real(1e-3) * radius;  // a face's own normal is more exact
    const Vec3 normal = flat ? out * (1 / length(out)) : d * (1 / distance);
    visit(from.name(t, on.feature), Touch{distance - radius, normal, normal * -(radius + (distance - radius) / 2)});
  });
}

/// The nearest triangle within `reach` of the origin, or -1.
template <class Surface>
GONOGO_HD inline Index nearest_triangle(const SurfaceFrom<Surface>& from, Real reach, OnTriangle& nearest) {
  const auto p = static_cast<Vec3>(from.origin);
  const Vec3 box{reach, reach, reach};
  Index best = -1;
  Real least = reach;
  from.surface.visit_near(p - box, p + box, [&](Index t) {
    const OnTriangle on = from.nearest(t);
    const Real distance = length(on.point);
    if (distance < least) {
      least = distance;
      best = t;
      nearest = on;
    }
  });
  return best;
}

/// A sphere on a mesh. `p`: its centre in the mesh's axes. A centre inside the mesh, within the sphere's reach of the
/// surface, is pushed out through the nearest face.
template <class Visit>
GONOGO_HD inline void visit_sphere_mesh_touches(const MeshSurface& mesh, const Vec3d& p, Real radius, Real envelope,
                                                Visit&& visit) {
  const SurfaceFrom<MeshSurface> from{mesh, p};
  OnTriangle on{};
  const Index t = nearest_triangle(from, radius + envelope, on);
  if (t < 0) return;
  const Vec3 out = from.outward(t, on.feature);
  if (dot(on.point, out) <= 0) {
    visit_outer_touches(from, radius, envelope, visit);
    return;
  }
  const Real depth = length(on.point), gap = -depth - radius;
  const Vec3 normal = on.feature == 0 || depth < Real(1e-3) * radius ? out * (1 / length(out)) : on.point * (1 / depth);
  visit(from.name(t, on.feature), Touch{gap, normal, normal * -(radius + gap / 2)});
}

/// Height of a point above the triangle of its column, along that triangle's normal. False outside of the grid.
GONOGO_HD inline bool height_above(const FieldSurface& field, const Vec3d& p, Index& t, Vec3& normal, Real& height) {
  t = field.triangle_at(p);
  if (t < 0) return false;
  const SurfaceFrom<FieldSurface> from{field, p};
  normal = from.normal(t);
  height = -dot(from.corner(t, 0), normal);
  return true;
}

/// A sphere on a heightfield. Below the ground, at any depth, it is pushed out along the normal of its column's
/// triangle.
template <class Visit>
GONOGO_HD inline void visit_sphere_field_touches(const FieldSurface& field, const Vec3d& p, Real radius, Real envelope,
                                                 Visit&& visit) {
  const SurfaceFrom<FieldSurface> from{field, p};
  Index t = -1;
  Vec3 normal;
  Real height = 0;
  if (!height_above(field, p, t, normal, height) || height >= 0) {
    visit_outer_touches(from, radius, envelope, visit);
    return;
  }
  const Real gap = height - radius;
  visit(from.name(t, 0), Touch{gap, normal, normal * -(radius + gap / 2)});
}

}  // namespace gonogo::sim
