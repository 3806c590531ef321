// Which pairs of shapes have a routine, and all contacts of a pair.
#pragma once
#include "sim/shape/touch/convex_pair.h"
#include "sim/shape/touch/field_touch.h"
#include "sim/shape/touch/mesh_mesh_touch.h"
#include "sim/shape/touch/solid_mesh_touch.h"
#include "sim/shape/touch/surface_touch.h"
#include "sim/shape/touch/touch.h"

namespace gonogo::sim {

/// Whether a routine handles two types of shape, in any order: all but two types of ground. check_pairs refuses scenes
/// in which others may touch.
GONOGO_HD constexpr bool have_routine(ShapeType a, ShapeType b) { return a < ShapeType::plane || b < ShapeType::plane; }

/// The two shapes of a pair with their axes in the world; `a` comes before `b` in the order of types. `d`: from b's
/// centre to a's [m].
struct ShapePair {
  const Shape &a, &b;
  const Quat &qa, &qb;
  Vec3d d;
  Real envelope;
  const SurfaceView& surfaces;
};

/// A sphere against a shape with a formula in gap.h.
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
    case ShapeType::ellipsoid:
      emit(0, sphere_ellipsoid_gap(p, size, radius));
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
  const auto height = Real(dot(pair.d, static_cast<Vec3d>(up)));
  visit_low_points(pair.a, pair.qa, up, [&](int feature, const Vec3& p) {
    const Real gap = height + dot(p, up);
    if (gap < pair.envelope) visit(feature, Touch{gap, up, p - up * (gap / 2)});
  });
}

inline constexpr int kPartShift = 22;  // of a part in the name of a solid's contact with a wheel

GONOGO_HD inline ShapeType core_type(ShapeType type) { return type == ShapeType::wheel ? ShapeType::cylinder : type; }

/// Calls visit(part, convex body) for the cylinder inside a wheel's lugs (part 0) and for the lugs (parts 1 + k) that
/// may be within `reach` of the point `near`. Other solids are part 0. `centre`: of the shape.
template <class Visit>
GONOGO_HD inline void visit_parts(const Shape& s, const Vec3& centre, const Quat& q, const Vec3& near, Real reach,
                                  Visit&& visit) {
  visit(0, convex(core_type(s.type), s.size, centre, q));
  if (s.type != ShapeType::wheel) return;
  const Vec3 half = lug_half(s);
  const Real max = length(half) + reach;
  for (int lug = 0; lug < s.lug_count; ++lug) {
    const LugFrame frame = lug_frame(s, lug);
    const Vec3 middle = centre + rotate(q, frame.out_of({s.size.x, 0, 0})), apart = middle - near;
    if (dot(apart, apart) >= max * max) continue;
    Convex box{ShapeType::box, half, middle, {}};
    box.axis[0] = rotate(q, frame.out_of({1, 0, 0}));
    box.axis[1] = rotate(q, {0, 1, 0});
    box.axis[2] = rotate(q, frame.out_of({0, 0, 1}));
    visit(1 + lug, box);
  }
}

/// Whether contact `feature` of a round shape and a wheel is on a lug, by the names of visit_sphere_touches and
/// visit_solid_touches.
GONOGO_HD inline bool is_on_lug(const Shape& a, const Shape& b, int feature) {
  if ((a.type == ShapeType::wheel) == (b.type == ShapeType::wheel)) return false;
  const bool sphere = a.type == ShapeType::sphere || b.type == ShapeType::sphere;
  return (sphere ? feature : feature >> kPartShift) > 0;
}

/// Capsules, ellipsoids, cylinders, boxes and the parts of wheels.
template <class Visit>
GONOGO_HD inline void visit_solid_touches(const ShapePair& pair, Visit&& visit) {
  const auto d = static_cast<Vec3>(pair.d);
  const bool wheels = pair.a.type == ShapeType::wheel;  // then both are
  visit_parts(pair.a, d, pair.qa, {}, bounding_radius(pair.b) + pair.envelope, [&](int part_a, const Convex& a) {
    visit_parts(pair.b, {}, pair.qb, d, bounding_radius(pair.a) + pair.envelope, [&](int part_b, const Convex& b) {
      const Vec3 to_centre = a.centre - d;
      visit_convex_touches(a, b, pair.envelope, [&](int feature, const Touch& t) {
        const int name = wheels ? feature_name(std::uint32_t(part_a), std::uint32_t(part_b), std::uint32_t(feature))
                                : feature + (part_b << kPartShift);
        visit(name, Touch{t.gap, t.normal, t.point + to_centre});
      });
    });
  });
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

/// Depths, as shares of the smaller body's smallest half extent, from which points are pushed out of meshes. A deeper
/// search of two meshes costs time.
inline constexpr Real kSolidLimit = Real(0.5), kMeshLimit = Real(0.25);

/// Visits the contacts of two meshes. Open ground has no thickness and sets no tolerance.
template <class Visit>
GONOGO_HD inline void visit_two_meshes(const ShapePair& pair, const MeshFrom& other, Visit&& visit) {
  const PlacedMesh placed{pair.surfaces.mesh_at(pair.a.surface), pair.qa, {}};
  const Real a = placed.mesh.range.open ? Real(0) : pair.a.size.y,
             b = other.surface.mesh.range.open ? Real(0) : pair.b.size.y;
  const Real half = a > 0 && b > 0 ? std::fmin(a, b) : std::fmax(a, b);
  MeshOnMesh<Visit>{MeshFrom{placed, {}}, other, tolerance_for(half, kMeshLimit, pair.envelope), visit}.run();
}

/// Spheres and capsules, ellipsoids, boxes, the parts of wheels, and meshes on a mesh.
template <class Visit>
GONOGO_HD inline void visit_mesh_touches(const ShapePair& pair, Visit&& visit) {
  const MeshSurface mesh = pair.surfaces.mesh_at(pair.b.surface);
  if (round_radius(pair.a) > 0) {
    const auto sphere = [&](const Vec3d& p, auto&& found) {
      visit_sphere_mesh_touches(mesh, p, pair.a.size.x, pair.envelope, found);
    };
    visit_round_touches(pair, mesh, sphere,
                        [&](int feature, const Touch& t) { visit(feature, turned_to_world(pair.qb, t)); });
    return;
  }
  const PlacedMesh placed{mesh, pair.qb, -pair.d};
  const MeshFrom from{placed, {}};
  if (pair.a.type == ShapeType::mesh) {
    visit_two_meshes(pair, from, visit);
    return;
  }
  const Tolerance tol = tolerance_for(smallest_half(pair.a), kSolidLimit, pair.envelope);
  if (pair.a.type == ShapeType::ellipsoid) {
    visit_ellipsoid_mesh_touches(from, convex(pair.a.type, pair.a.size, {}, pair.qa), tol, visit);
    return;
  }
  visit_parts(pair.a, {}, pair.qa, static_cast<Vec3>(-pair.d), bounding_radius(pair.b) + pair.envelope,
              [&](int part, const Convex& solid) {
                visit_solid_mesh_touches(from, solid, part, pair.a.size.x - tol.slack, tol, visit);
              });
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

/// Not inlined into find_touches, so that pairs of simple shapes need fewer registers.
GONOGO_HD_OUTLINED void find_mesh_touches(const ShapePair& pair, TouchWindow& found) {
  TouchChooser chooser(found);
  do {
    if (pair.b.type == ShapeType::plane)
      visit_mesh_plane_touches(pair.surfaces.mesh_at(pair.a.surface), pair.qa, pair.d, rotate(pair.qb, {0, 0, 1}),
                               pair.envelope, chooser);
    else if (pair.b.type == ShapeType::heightfield)
      visit_field_touches(pair, chooser);
    else
      visit_mesh_touches(pair, chooser);
  } while (chooser.next_pass());
}

/// The same for two convex bodies.
GONOGO_HD_OUTLINED void find_solid_touches(const ShapePair& pair, TouchWindow& found) {
  visit_solid_touches(pair, found);
}

/// Finds the contacts of the pair with gaps below the envelope, owned by `a`. A feature names the contact inside the
/// pair and stays the same while the bodies move. One function for all pairs, not inlined, because its code is large.
GONOGO_HD_OUTLINED void find_touches(const ShapePair& pair, TouchWindow& found) {
  found.total = 0;
  if (pair.a.type == ShapeType::mesh || pair.b.type == ShapeType::mesh || pair.b.type == ShapeType::heightfield)
    find_mesh_touches(pair, found);
  else if (pair.b.type == ShapeType::plane)
    visit_plane_touches(pair, found);
  else if (pair.a.type == ShapeType::sphere)
    visit_sphere_touches(pair, found);
  else
    find_solid_touches(pair, found);
}

/// Calls visit(feature, touch) for every contact of the pair, in as many windows as needed.
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
