// Which pairs of shapes have a routine, and all contacts of a pair.
#pragma once
#include "sim/shape/capsule_touch.h"
#include "sim/shape/convex_pair.h"
#include "sim/shape/field_touch.h"

namespace gonogo::sim {

/// Whether two types of shape can meet, whichever comes first. Scenes in which others may meet are refused.
GONOGO_HD constexpr bool have_routine(ShapeType a, ShapeType b) {
  if (b < a) return have_routine(b, a);
  switch (b) {
    case ShapeType::wheel:
      return a != ShapeType::wheel;
    case ShapeType::mesh:
      return a == ShapeType::sphere || a == ShapeType::capsule;
    case ShapeType::plane:
    case ShapeType::heightfield:
      return a < ShapeType::plane;
    default:
      return true;
  }
}

/// The two shapes of a pair with their axes in the world; `a` comes before `b` in the order of types. `d`: from b's
/// centre to a's [m].
struct ShapePair {
  const Shape &a, &b;
  const Quat &qa, &qb;
  Vec3d d;
  Real envelope;
  const SurfaceView& surfaces;
};

/// A sphere against one of the shapes that a formula of gap.h serves.
template <class Visit>
GONOGO_HD inline void visit_sphere_touches(const ShapePair& pair, Visit&& visit) {
  const Real radius = pair.a.size.x;
  const Vec3& size = pair.b.size;
  const Vec3 p = rotate_back(pair.qb, static_cast<Vec3>(pair.d));
  const auto emit = [&](int feature, const Gap& g) {
    if (g.gap >= pair.envelope) return;
    const Vec3 normal = rotate(pair.qb, g.normal);
    visit(feature, Touch{g.gap, normal, normal * -(radius + g.gap / 2)});
  };
  switch (pair.b.type) {
    case ShapeType::sphere:
      emit(0, sphere_sphere_gap(p, radius + size.x));
      return;
    case ShapeType::capsule:
      emit(0, sphere_capsule_gap(p, size.x, size.y, radius));
      return;
    case ShapeType::cylinder:
      emit(0, sphere_cylinder_gap(p, size.x, size.y, radius));
      return;
    case ShapeType::box:
      emit(0, sphere_box_gap(p, size, radius));
      return;
    case ShapeType::wheel:
      visit_wheel_gaps(p, pair.b, radius, pair.envelope, emit);
      return;
    default:
      return;
  }
}

/// The lowest points of a shape against a plane.
template <class Visit>
GONOGO_HD inline void visit_plane_touches(const ShapePair& pair, Visit&& visit) {
  const Vec3 up = rotate(pair.qb, {0, 0, 1});
  if (pair.a.type == ShapeType::mesh) {
    visit_mesh_plane_touches(pair.surfaces.mesh_at(pair.a.surface), pair.qa, pair.d, up, pair.envelope, visit);
    return;
  }
  const auto height = Real(dot(pair.d, static_cast<Vec3d>(up)));
  visit_low_points(pair.a, pair.qa, up, [&](int feature, const Vec3& p) {
    const Real gap = height + dot(p, up);
    if (gap < pair.envelope) visit(feature, Touch{gap, up, p - up * (gap / 2)});
  });
}

GONOGO_HD inline ShapeType core_type(ShapeType type) { return type == ShapeType::wheel ? ShapeType::cylinder : type; }

/// Capsules, cylinders, boxes and the cylinder inside a wheel's lugs.
template <class Visit>
GONOGO_HD inline void visit_solid_touches(const ShapePair& pair, Visit&& visit) {
  const Convex a = convex(core_type(pair.a.type), pair.a.size, static_cast<Vec3>(pair.d), pair.qa);
  const Convex b = convex(core_type(pair.b.type), pair.b.size, {}, pair.qb);
  visit_convex_touches(a, b, pair.envelope, visit);
  if (pair.b.type != ShapeType::wheel) return;
  const Vec3 half = lug_half(pair.b);
  const Real reach = length(half) + bounding_radius(pair.a) + pair.envelope;
  for (int lug = 0; lug < pair.b.lug_count; ++lug) {
    const LugFrame frame = lug_frame(pair.b, lug);
    const Vec3 centre = rotate(pair.qb, frame.out_of({pair.b.size.x, 0, 0})), apart = a.centre - centre;
    if (dot(apart, apart) >= reach * reach) continue;
    Convex box{ShapeType::box, half, centre, {}};
    box.axis[0] = rotate(pair.qb, frame.out_of({1, 0, 0}));
    box.axis[1] = rotate(pair.qb, {0, 1, 0});
    box.axis[2] = rotate(pair.qb, frame.out_of({0, 0, 1}));
    visit_convex_touches(a, box, pair.envelope,
                         [&](int feature, const Touch& t) { visit(feature + ((lug + 1) << 22), t); });
  }
}

/// Spheres and capsules on a mesh or heightfield, in its axes.
template <class Surface, class Sphere, class Visit>
GONOGO_HD inline void visit_round_touches(const ShapePair& pair, const Surface& surface, Sphere&& sphere,
                                          Visit&& visit) {
  const Vec3d p = in_frame(pair.qb, pair.d);
  if (pair.a.type == ShapeType::sphere) {
    sphere(p, visit);
    return;
  }
  const Vec3 half = rotate_back(pair.qb, rotate(pair.qa, {0, pair.a.size.y, 0}));
  visit_capsule_touches(surface, p, half, pair.a.size.x, pair.envelope, sphere, visit);
}

template <class Visit>
GONOGO_HD inline void visit_mesh_touches(const ShapePair& pair, Visit&& visit) {
  const MeshSurface mesh = pair.surfaces.mesh_at(pair.b.surface);
  const auto sphere = [&](const Vec3d& p, auto&& found) {
    visit_sphere_mesh_touches(mesh, p, pair.a.size.x, pair.envelope, found);
  };
  visit_round_touches(pair, mesh, sphere,
                      [&](int feature, const Touch& t) { visit(feature, turned_to_world(pair.qb, t)); });
}

template <class Visit>
GONOGO_HD inline void visit_field_touches(const ShapePair& pair, Visit&& visit) {
  const FieldSurface field = pair.surfaces.field_at(pair.b.surface);
  const auto emit = [&](int feature, const Touch& t) { visit(feature, turned_to_world(pair.qb, t)); };
  const Quat q = conjugate(pair.qb) * pair.qa;
  const Vec3d p = in_frame(pair.qb, pair.d);
  if (round_radius(pair.a) > 0) {
    const auto sphere = [&](const Vec3d& at, auto&& found) {
      visit_sphere_field_touches(field, at, pair.a.size.x, pair.envelope, found);
    };
    visit_round_touches(pair, field, sphere, emit);
  } else if (pair.a.type == ShapeType::mesh) {
    visit_mesh_field_touches(pair.surfaces.mesh_at(pair.a.surface), field, q, p, pair.envelope, emit);
  } else {
    visit_solid_field_touches(field, OnField{pair.a, q, p, pair.envelope}, emit);
  }
}

/// Finds the contacts of the pair with gaps below the envelope, owned by `a`. A feature names the contact inside the
/// pair and keeps its name while the bodies move. All pairs of shapes in one function that is compiled once: they would
/// fill every loop over pairs with their code.
GONOGO_HD_OUTLINED void find_touches(const ShapePair& pair, TouchWindow& found) {
  found.total = 0;
  if (pair.b.type == ShapeType::plane)
    visit_plane_touches(pair, found);
  else if (pair.b.type == ShapeType::heightfield)
    visit_field_touches(pair, found);
  else if (pair.b.type == ShapeType::mesh)
    visit_mesh_touches(pair, found);
  else if (pair.a.type == ShapeType::sphere)
    visit_sphere_touches(pair, found);
  else
    visit_solid_touches(pair, found);
}

/// Calls visit(feature, touch) for every contact of the pair; a mesh on a plane may have more than a window holds.
template <class Visit>
GONOGO_HD inline void visit_touches(const ShapePair& pair, Visit&& visit) {
  TouchWindow found;
  do {
    find_touches(pair, found);
    const int count = found.count();
    for (int k = 0; k < count; ++k) visit(found.feature[k], found.touch[k]);
    found.first += TouchWindow::kRoom;
  } while (found.first < found.total);
}

}  // namespace gonogo::sim
