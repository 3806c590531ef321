// Spheres and capsules on surfaces of triangles. A triangle's nearest point is a contact only where the distance to the
// whole surface has a local minimum, that is where no neighbour has a nearer point. So a sphere on a flat floor has one
// contact for any triangulation, and on a ridge one with the ridge.
// A capsule touches with its two ends, as spheres do, and between them with the ridges and peaks.
#pragma once
#include "sim/shape/surface.h"
#include "sim/shape/touch/touch.h"

namespace gonogo::sim {

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

/// Segment from -half to half through the origin, both ends included.
struct Segment {
  Vec3 half;
  GONOGO_HD Real nearest(const Vec3& p) const {  // in -1 .. 1
    return std::fmin(std::fmax(dot(p, half) / dot(half, half), Real(-1)), Real(1));
  }
};

/// Where segment and edge are nearest: s along the segment (-1 .. 1), t along the edge (0 .. 1). Ericson (2005), 5.1.9.
GONOGO_HD inline void nearest_parameters(const Segment& segment, const Vec3& from, const Vec3& edge, Real& s, Real& t) {
  const Vec3& u = segment.half;
  const Real a = dot(u, u), e = dot(edge, edge), b = dot(u, edge), c = -dot(u, from), f = -dot(edge, from);
  const Real area = a * e - b * b;
  s = area > Real(1e-6) * a * e ? std::fmin(std::fmax((b * f - c * e) / area, Real(-1)), Real(1)) : Real(0);
  t = std::fmin(std::fmax((b * s + f) / e, Real(0)), Real(1));
  s = segment.nearest(from + edge * t);
}

/// Contacts of the middle part of a capsule whose centre is the origin of `from`.
template <class Surface, class Visit>
struct CapsuleMiddle {
  const SurfaceFrom<Surface>& from;
  Segment segment;
  Real radius, envelope;
  Visit& visit;

  GONOGO_HD void contact(Index t, int feature, Real s, const Vec3& on_surface) {
    const Vec3 on_axis = segment.half * s, d = on_axis - on_surface;
    const Real distance = length(d), gap = distance - radius;
    if (gap >= envelope || distance < Real(1e-6) * radius || std::fabs(s) > Real(0.999)) return;
    if (dot(d, from.outward(t, feature)) <= 0) return;
    const Vec3 normal = d * (1 / distance);
    visit(from.name(t, feature), Touch{gap, normal, on_axis - normal * (radius + gap / 2)});
  }

  /// Ridges only: on a flat or hollow edge the ends carry the capsule.
  GONOGO_HD void edge(Index t, int k) {
    const Index other = from.surface.neighbour(t, k);
    if (other >= 0 && other < t) return;
    const Vec3 start = from.corner(t, k), edge = from.corner(t, (k + 1) % 3) - start;
    const Vec3 beyond = from.across(t, k), inward = from.corner(t, (k + 2) % 3) - start;
    if (other >= 0 && dot(beyond, from.normal(t)) > Real(-1e-3) * length(beyond)) return;
    Real s = 0, along = 0;
    nearest_parameters(segment, start, edge, s, along);
    if (along <= 0 || along >= 1) return;
    const Vec3 on_edge = start + edge * along, d = segment.half * s - on_edge;
    const Vec3 in = inward - edge * (dot(inward, edge) / dot(edge, edge));
    const Real slack = SurfaceFrom<Surface>::kSlack * length(d);
    if (dot(d, in) > slack * length(in) || dot(d, beyond) > slack * length(beyond)) return;
    contact(t, 1 + k, s, on_edge);
  }

  GONOGO_HD void corner(Index t, int k) {
    const Vec3 p = from.corner(t, k);
    const Real s = segment.nearest(p);
    if (from.is_local_minimum(t, 4 + k, segment.half * s - p)) contact(t, 4 + k, s, p);
  }
};

/// Calls visit(feature, touch) in the surface's axes. `p`, `half`: the capsule's centre and half its axis there.
/// sphere(p, visit) visits the contacts of one end. Features: 4 times that of a sphere, plus 0 or 1 for the ends, 2
/// between them.
template <class Surface, class Sphere, class Visit>
GONOGO_HD inline void visit_capsule_touches(const Surface& surface, const Vec3d& p, const Vec3& half, Real radius,
                                            Real envelope, Sphere&& sphere, Visit&& visit) {
  for (int end = 0; end < 2; ++end) {
    const Vec3 to_end = end == 0 ? -half : half;
    sphere(p + static_cast<Vec3d>(to_end), [&](int feature, const Touch& t) {
      visit(4 * feature + end, Touch{t.gap, t.normal, t.point + to_end});
    });
  }
  const SurfaceFrom<Surface> from{surface, p};
  const auto emit = [&](int feature, const Touch& t) { visit(4 * feature + 2, t); };
  CapsuleMiddle<Surface, decltype(emit)> middle{from, {half}, radius, envelope, emit};
  const Real reach = radius + envelope;
  const Vec3 box{std::fabs(half.x) + reach, std::fabs(half.y) + reach, std::fabs(half.z) + reach};
  surface.visit_near(static_cast<Vec3>(p) - box, static_cast<Vec3>(p) + box, [&](Index t) {
    for (int k = 0; k < 3; ++k) {
      middle.edge(t, k);
      middle.corner(t, k);
    }
  });
}

}  // namespace gonogo::sim
