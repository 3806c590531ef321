// Ellipsoids, boxes, cylinders and wheels on heightfields, and vertices of meshes on heightfields and planes.
#pragma once
#include "sim/shape/touch/convex.h"
#include "sim/shape/touch/surface_touch.h"

namespace gonogo::sim {

/// A shape with its axes `q` and centre `p` in those of the heightfield.
struct OnField {
  const Shape& shape;
  const Quat& q;
  const Vec3d& p;
  Real envelope;

  /// Names of contacts: the low point's in 12 bits, above them its triangle's modulo 2^18. Triangles with equal names
  /// are too far apart to touch one shape. Ridges and peaks set the highest bits.
  GONOGO_HD static int low_name(Index triangle, int feature) {
    return ((triangle & 0x3FFFF) << 12) | (feature & 0xFFF);
  }
  static constexpr int kRidge = 1 << 30;
};

/// A low point of the shape over the triangle whose normal makes it lowest.
template <class Visit>
GONOGO_HD inline void visit_low_touches(const FieldSurface& field, const OnField& on, Index t, Visit&& visit) {
  const SurfaceFrom<FieldSurface> from{field, on.p};
  const Vec3 normal = from.normal(t), base = from.corner(t, 0);
  visit_low_points(on.shape, on.q, normal, [&](int feature, const Vec3& point) {
    const Real gap = dot(point - base, normal);
    if (gap >= on.envelope || field.triangle_at(on.p + static_cast<Vec3d>(point)) != t) return;
    visit(OnField::low_name(field.name(t), feature), Touch{gap, normal, point - normal * (gap / 2)});
  });
}

/// Distance of a point to an ellipsoid, box or cylinder; a wheel counts as the cylinder inside its lugs. `p`: in the
/// shape's axes.
GONOGO_HD inline Gap point_solid_gap(const Shape& s, const Vec3& p) {
  if (s.type == ShapeType::ellipsoid) return sphere_ellipsoid_gap(p, s.size, 0);
  return s.type == ShapeType::box ? sphere_box_gap(p, s.size, 0) : sphere_cylinder_gap(p, s.size.x, s.size.y, 0);
}

/// A ridge or peak inside the shape. `point`: from the shape's centre; `outward`: out of the shape; field axes.
template <class Visit>
GONOGO_HD inline void emit_ridge(const OnField& on, int name, const Gap& g, const Vec3& point, Visit&& visit) {
  const Vec3 normal = -rotate(on.q, g.normal);
  if (g.gap < on.envelope && normal.z > Real(0.1))  // sideways pushes come from points deep below another face
    visit(OnField::kRidge | name, Touch{g.gap, normal, point + normal * (g.gap / 2)});
}

/// Edge k of a triangle, if it is a ridge, at its point deepest in the shape. The distance to a convex shape is convex
/// along a line, so a golden-section search finds it. Ridges that meet in a peak all give the peak's contact.
template <class Visit>
GONOGO_HD inline void visit_ridge_touches(const FieldSurface& field, const OnField& on, Index t, int k, Visit&& visit) {
  const Index other = field.neighbour(t, k);
  if (other >= 0 && other < t) return;
  const SurfaceFrom<FieldSurface> from{field, on.p};
  const Vec3 beyond = from.across(t, k);
  if (other >= 0 && dot(beyond, from.normal(t)) > Real(-1e-3) * length(beyond)) return;
  const Vec3 start = from.corner(t, k), edge = from.corner(t, (k + 1) % 3) - start;
  const auto gap_at = [&](Real x) { return point_solid_gap(on.shape, rotate_back(on.q, start + edge * x)).gap; };
  const Real section = Real(0.6180339887);
  Real low = 0, high = 1, a = high - section, b = low + section, gap_a = gap_at(a), gap_b = gap_at(b);
  for (int i = 0; i < 24; ++i) {
    if (gap_a < gap_b) {
      high = b;
      b = a;
      gap_b = gap_a;
      a = high - section * (high - low);
      gap_a = gap_at(a);
    } else {
      low = a;
      a = b;
      gap_a = gap_b;
      b = low + section * (high - low);
      gap_b = gap_at(b);
    }
  }
  const Vec3 point = start + edge * ((low + high) / 2);
  const Gap g = point_solid_gap(on.shape, rotate_back(on.q, point));
  emit_ridge(on, (3 * t + k) & 0x3FFFFFFF, g, point, visit);
}

/// An ellipsoid, box, cylinder or wheel on a heightfield: its lowest point, corners, rims and lug corners on the
/// triangles below them, and the ground's ridges against its faces.
template <class Visit>
GONOGO_HD inline void visit_solid_field_touches(const FieldSurface& field, const OnField& on, Visit&& visit) {
  const Real reach = bounding_radius(on.shape) + on.envelope;
  const Vec3 box{reach, reach, reach}, p = static_cast<Vec3>(on.p);
  field.visit_near(p - box, p + box, [&](Index t) {
    visit_low_touches(field, on, t, visit);
    for (int k = 0; k < 3; ++k) visit_ridge_touches(field, on, t, k, visit);
  });
}

/// Calls visit(vertex, position) for the vertices of a mesh, except in boxes for which may_skip(middle, half).
template <class Skip, class Visit>
GONOGO_HD inline void visit_mesh_vertices(const MeshSurface& mesh, Skip&& may_skip, Visit&& visit) {
  for (Index n = 0; n < mesh.range.node_count;) {
    const MeshNode& at = mesh.node[n];
    if (may_skip((at.low + at.high) * Real(0.5), (at.high - at.low) * Real(0.5))) {
      n = at.skip;
      continue;
    }
    for (Index t = at.first; t < at.first + at.count; ++t)
      for (int k = 0; k < 3; ++k)
        if (mesh.has(MeshMark::first, t, k)) visit(mesh.vertex(t, k), mesh.corner[mesh.vertex(t, k)]);
    ++n;
  }
}

/// Vertices of a mesh on a plane through the origin of world axes; `up`: its normal, `q`, `d`: axes and centre of the
/// mesh.
template <class Visit>
GONOGO_HD inline void visit_mesh_plane_touches(const MeshSurface& mesh, const Quat& q, const Vec3d& d, const Vec3& up,
                                               Real envelope, Visit&& visit) {
  const Vec3 up_B = rotate_back(q, up);
  const auto height = Real(dot(d, static_cast<Vec3d>(up)));
  const auto above = [&](const Vec3& middle, const Vec3& half) {
    const Real reach = std::fabs(up_B.x) * half.x + std::fabs(up_B.y) * half.y + std::fabs(up_B.z) * half.z;
    return height + dot(up_B, middle) - reach >= envelope;
  };
  visit_mesh_vertices(mesh, above, [&](Index v, const Vec3& p) {
    const Real gap = height + dot(up_B, p);
    if (gap < envelope) visit(int(v), Touch{gap, up, rotate(q, p) - up * (gap / 2)});
  });
}

/// Vertices of a mesh on a heightfield; `q`, `d`: axes and centre of the mesh in those of the field.
template <class Visit>
GONOGO_HD inline void visit_mesh_field_touches(const MeshSurface& mesh, const FieldSurface& field, const Quat& q,
                                               const Vec3d& d, Real envelope, Visit&& visit) {
  const auto above = [&](const Vec3& middle, const Vec3& half) {
    return Real(d.z) + rotate(q, middle).z - length(half) >= field.range.high + envelope;
  };
  visit_mesh_vertices(mesh, above, [&](Index v, const Vec3& p) {
    const Vec3 point = rotate(q, p);
    Index t = -1;
    Vec3 normal;
    Real gap = 0;
    if (height_above(field, d + static_cast<Vec3d>(point), t, normal, gap) && gap < envelope)
      visit(int(v), Touch{gap, normal, point - normal * (gap / 2)});
  });
}

}  // namespace gonogo::sim
