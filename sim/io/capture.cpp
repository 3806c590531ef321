#include "sim/io/capture.h"

#include <algorithm>

#include "base/error.h"
#include "base/units.h"
#include "sim/shape/touch/convex.h"

namespace gonogo::sim {
namespace {

constexpr Real kTurn = Real(2 * kPi);

Index add_point(Surface& s, const Vec3& point, const Vec3& normal) {
  s.point.push_back(point);
  s.normal.push_back(normal);
  return Index(s.point.size()) - 1;
}

/// Flat four-sided face through centre +- u +- v; u x v points outward.
void add_face(Surface& s, const Vec3& centre, const Vec3& u, const Vec3& v) {
  const Vec3 across = cross(u, v), normal = across * (1 / length(across));
  const Index first = add_point(s, centre - u - v, normal);
  add_point(s, centre + u - v, normal);
  add_point(s, centre + u + v, normal);
  add_point(s, centre - u + v, normal);
  s.triangle.push_back({first, first + 1, first + 2});
  s.triangle.push_back({first, first + 2, first + 3});
}

/// One triangle with its own normal.
void add_flat(Surface& s, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 across = cross(b - a, c - a), normal = across * (1 / length(across));
  const Index first = add_point(s, a, normal);
  add_point(s, b, normal);
  add_point(s, c, normal);
  s.triangle.push_back({first, first + 1, first + 2});
}

/// Box with half edges along three perpendicular, right-handed axes.
void add_box(Surface& s, const Vec3& centre, const Vec3& x, const Vec3& y, const Vec3& z) {
  add_face(s, centre + x, y, z);
  add_face(s, centre - x, z, y);
  add_face(s, centre + y, z, x);
  add_face(s, centre - y, x, z);
  add_face(s, centre + z, x, y);
  add_face(s, centre - z, y, x);
}

/// Direction across the y axis at a share of a full turn; from x towards z.
Vec3 around_y(int k, int segments) {
  const Real angle = kTurn * Real(k) / Real(segments);
  return {std::cos(angle), 0, std::sin(angle)};
}

/// Disc of a cylinder about the y axis; `side` is +1 or -1.
void add_disc(Surface& s, Real radius, Real half_width, Real side, int segments) {
  const Vec3 normal{0, side, 0};
  const Index middle = add_point(s, normal * half_width, normal);
  for (int k = 0; k < segments; ++k) add_point(s, around_y(k, segments) * radius + normal * half_width, normal);
  for (int k = 0; k < segments; ++k) {
    const Index here = middle + 1 + k, next = middle + 1 + (k + 1) % segments;
    s.triangle.push_back(side > 0 ? std::array{middle, next, here} : std::array{middle, here, next});
  }
}

/// Cylinder about the y axis with both ends.
void add_cylinder(Surface& s, Real radius, Real half_width, int segments) {
  const Index first = Index(s.point.size());
  for (int k = 0; k < segments; ++k) {
    const Vec3 out = around_y(k, segments);
    add_point(s, out * radius - Vec3{0, half_width, 0}, out);
    add_point(s, out * radius + Vec3{0, half_width, 0}, out);
  }
  for (int k = 0; k < segments; ++k) {
    const Index left = first + 2 * k, next = first + 2 * ((k + 1) % segments);
    s.triangle.push_back({left, left + 1, next + 1});
    s.triangle.push_back({left, next + 1, next});
  }
  add_disc(s, radius, half_width, 1, segments);
  add_disc(s, radius, half_width, -1, segments);
}

/// Latitude and longitude; rows of equal angle from pole to pole.
void add_sphere(Surface& s, Real radius, int segments, int rows) {
  for (int row = 0; row <= rows; ++row) {
    const Real polar = kTurn / 2 * Real(row) / Real(rows);
    for (int k = 0; k < segments; ++k) {
      const Vec3 side = around_y(k, segments);
      const Vec3 out = side * std::sin(polar) + Vec3{0, std::cos(polar), 0};
      add_point(s, out * radius, out);
    }
  }
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < segments; ++k) {
      const Index here = row * segments + k, next = row * segments + (k + 1) % segments;
      if (row > 0) s.triangle.push_back({here, next, next + segments});
      if (row + 1 < rows) s.triangle.push_back({here, next + segments, here + segments});
    }
}

/// A sphere stretched along its axes; normals go with the inverse of the stretch.
void add_ellipsoid(Surface& s, const Vec3& half, int segments, int rows) {
  const std::size_t first = s.point.size();
  add_sphere(s, 1, segments, rows);
  for (std::size_t i = first; i < s.point.size(); ++i) {
    s.point[i] = scale(half, s.point[i]);
    s.normal[i] = ellipsoid_normal(half, s.point[i]);
  }
}

/// Two half spheres and the band between them.
void add_capsule(Surface& s, Real radius, Real half_length, int segments) {
  const std::size_t first = s.point.size();
  add_sphere(s, radius, segments, segments / 2 | 1);  // an odd number of rows: none of them lies on the equator
  for (std::size_t i = first; i < s.point.size(); ++i) s.point[i].y += s.point[i].y > 0 ? half_length : -half_length;
}

/// Cylinder of the rim and one box per lug, placed as sphere_lug_gap places them.
void add_wheel(Surface& s, const Shape& wheel, int segments) {
  add_cylinder(s, wheel.size.x, wheel.size.y, segments);
  for (int k = 0; k < wheel.lug_count; ++k) {
    const Vec3 out = around_y(k, wheel.lug_count), along{-out.z, 0, out.x};
    add_box(s, out * wheel.size.x, out * wheel.size.z, {0, wheel.size.y, 0}, along * (wheel.lug_thickness / 2));
  }
}

}  // namespace

Surface surface_of(const Shape& shape, const SurfaceDetail& detail) {
  if (detail.segments < 3) throw InputError("a round surface needs at least 3 segments around a turn");
  Surface s;
  const Vec3& size = shape.size;
  switch (shape.type) {
    case ShapeType::sphere:
      add_sphere(s, size.x, detail.segments, std::max(2, detail.segments / 2));
      break;
    case ShapeType::capsule:
      add_capsule(s, size.x, size.y, detail.segments);
      break;
    case ShapeType::ellipsoid:
      add_ellipsoid(s, size, detail.segments, std::max(2, detail.segments / 2));
      break;
    case ShapeType::cylinder:
      add_cylinder(s, size.x, size.y, detail.segments);
      break;
    case ShapeType::box:
      add_box(s, {}, {size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z});
      break;
    case ShapeType::plane:
      add_face(s, {}, {detail.plane_half, 0, 0}, {0, detail.plane_half, 0});
      break;
    case ShapeType::wheel:
      add_wheel(s, shape, detail.segments);
      break;
    case ShapeType::mesh:
    case ShapeType::heightfield:
      throw InputError("the surface of a mesh or heightfield is known to its world only");
    case ShapeType::none:
      break;
  }
  return s;
}

Surface surface_of(const SceneWorld& world, const Shape& shape, const SurfaceDetail& detail) {
  Surface s;
  if (shape.type == ShapeType::mesh) {
    const TriangleMesh& mesh = *world.mesh[shape.surface];
    for (const auto& [a, b, c] : mesh.triangle) add_flat(s, mesh.vertex[a], mesh.vertex[b], mesh.vertex[c]);
    return s;
  }
  if (shape.type != ShapeType::heightfield) return surface_of(shape, detail);
  const Heightfield& f = *world.heightfield[shape.surface];
  const auto at = [&](Index i, Index j) {
    return Vec3{(Real(i) - Real(f.nx - 1) / 2) * f.spacing_x, (Real(j) - Real(f.ny - 1) / 2) * f.spacing_y,
                f.height[j * f.nx + i]};
  };
  for (Index j = 0; j + 1 < f.ny; ++j)
    for (Index i = 0; i + 1 < f.nx; ++i) {
      add_flat(s, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_flat(s, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return s;
}

Capture capture_world(Simulation& simulation, WorldIndex world) {
  Capture capture{.time = simulation.report(world).time, .body = simulation.bodies(world)};
  const auto contact = simulation.contacts(world);
  const auto impulse = simulation.impulses(world);
  for (std::size_t i = 0; i < contact.size(); ++i) {
    const Contact& c = contact[i];
    const Vec3d point = capture.body[c.body_a].position + static_cast<Vec3d>(c.arm_a);
    capture.contact.push_back({point, c.normal, impulse[i].linear, c.gap, c.body_a, c.body_b});
  }
  return capture;
}

Vec3d centre_of(const Shape& shape, const BodyState& body) {
  return body.position + static_cast<Vec3d>(rotate(body.orientation, shape.offset_B));
}

Vec3 velocity_of(const Shape& shape, const BodyState& body) {
  return body.velocity + cross(body.angular_velocity, rotate(body.orientation, shape.offset_B));
}

}  // namespace gonogo::sim
