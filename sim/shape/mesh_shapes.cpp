#include "sim/shape/mesh_shapes.h"

#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "sim/shape/welder.h"

namespace gonogo::sim {
namespace {

/// Squares over corner + u [0, 1] + v [0, 1]; u x v points outward.
void add_grid(TriangleMesh& mesh, Welder& weld, const Vec3& corner, const Vec3& u, const Vec3& v, int cells) {
  const auto at = [&](int i, int j) {
    // Ends exactly on the corners, so that faces share them.
    const Real a = i == cells ? Real(1) : Real(i) / Real(cells), b = j == cells ? Real(1) : Real(j) / Real(cells);
    return weld.add(corner + u * a + v * b);
  };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      mesh.triangle.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangle.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
}

/// Prism about y over a polygon (x, z) that is star-shaped about the axis and runs from z towards x.
TriangleMesh prism(const std::vector<std::pair<Real, Real>>& outline, Real half_length) {
  TriangleMesh mesh;
  const auto n = Index(outline.size());
  for (const Real y : {-half_length, half_length}) {
    for (const auto& [x, z] : outline) mesh.vertex.push_back({x, y, z});
    mesh.vertex.push_back({0, y, 0});
  }
  for (Index k = 0; k < n; ++k) {
    const Index here = k, next = (k + 1) % n, up = n + 1;
    mesh.triangle.push_back({here, next, next + up});
    mesh.triangle.push_back({here, next + up, here + up});
    mesh.triangle.push_back({n, next, here});                 // y < 0
    mesh.triangle.push_back({n + up, here + up, next + up});  // y > 0
  }
  return mesh;
}

std::pair<Real, Real> on_rim(double radius, double angle) {
  return {Real(radius * std::sin(angle)), Real(radius * std::cos(angle))};
}

}  // namespace

TriangleMesh box_mesh(const Vec3& h, int cells) {
  TriangleMesh mesh;
  mesh.name = "box";
  Welder weld(mesh);
  const Vec3 x{2 * h.x, 0, 0}, y{0, 2 * h.y, 0}, z{0, 0, 2 * h.z};
  add_grid(mesh, weld, {-h.x, -h.y, -h.z}, y, x, cells);
  add_grid(mesh, weld, {-h.x, -h.y, h.z}, x, y, cells);
  add_grid(mesh, weld, {-h.x, -h.y, -h.z}, x, z, cells);
  add_grid(mesh, weld, {-h.x, h.y, -h.z}, z, x, cells);
  add_grid(mesh, weld, {-h.x, -h.y, -h.z}, z, y, cells);
  add_grid(mesh, weld, {h.x, -h.y, -h.z}, y, z, cells);
  return mesh;
}

TriangleMesh cylinder_mesh(Real radius, Real half_length, int segments) {
  if (segments < 3) throw InputError("a cylinder mesh needs at least 3 segments");
  std::vector<std::pair<Real, Real>> outline;
  for (int k = 0; k < segments; ++k) outline.push_back(on_rim(radius, 2 * kPi * k / segments));
  TriangleMesh mesh = prism(outline, half_length);
  mesh.name = "cylinder";
  return mesh;
}

TriangleMesh tyre_mesh(const Shape& wheel, int segments) {
  const double radius = wheel.size.x, tip = radius + wheel.size.z, half = 0.5 * double(wheel.lug_thickness);
  const double pitch = wheel.lug_count > 0 ? 2 * kPi / wheel.lug_count : 0, foot = std::asin(half / radius);
  if (wheel.lug_count == 0) return cylinder_mesh(wheel.size.x, wheel.size.y, segments);
  if (!(2 * foot < pitch)) throw InputError("the lugs of the tyre leave no room between them");
  std::vector<std::pair<Real, Real>> outline;
  for (int lug = 0; lug < wheel.lug_count; ++lug) {
    // Lug k of a wheel lies at the angle k pitch from x towards z; outlines run the other way, from z towards x.
    const double middle = kPi / 2 + lug * pitch;
    const double s = std::sin(middle), c = std::cos(middle);
    outline.push_back(on_rim(radius, middle - foot));
    outline.push_back({Real(tip * s - half * c), Real(tip * c + half * s)});
    outline.push_back({Real(tip * s + half * c), Real(tip * c - half * s)});
    for (int k = 0; k < segments; ++k)
      outline.push_back(on_rim(radius, middle + foot + (pitch - 2 * foot) * k / segments));
  }
  TriangleMesh mesh = prism(outline, wheel.size.y);
  mesh.name = "tyre";
  return mesh;
}

TriangleMesh revolved_mesh(const std::vector<std::pair<Real, Real>>& profile, int segments) {
  if (segments < 3 || profile.size() < 3)
    throw InputError("a solid of revolution needs at least 3 segments and 3 points of its profile");
  TriangleMesh mesh;
  mesh.name = "solid of revolution";
  const auto n = Index(profile.size());
  for (int k = 0; k < segments; ++k) {
    const double angle = 2 * kPi * k / segments, c = std::cos(angle), s = std::sin(angle);
    for (const auto& [r, z] : profile) {
      if (!(r > 0)) throw InputError("a solid of revolution must keep off its axis");
      mesh.vertex.push_back({Real(r * c), Real(r * s), z});
    }
  }
  for (int k = 0; k < segments; ++k)
    for (Index i = 0; i < n; ++i) {
      const Index j = (i + 1) % n, here = k * n, next = (k + 1) % segments * n;
      mesh.triangle.push_back({here + i, next + j, here + j});
      mesh.triangle.push_back({here + i, next + i, next + j});
    }
  return mesh;
}

TriangleMesh floor_mesh(Real half_edge, int cells) {
  TriangleMesh mesh;
  mesh.name = "floor";
  mesh.open = true;
  Welder weld(mesh);
  add_grid(mesh, weld, {-half_edge, -half_edge, 0}, {2 * half_edge, 0, 0}, {0, 2 * half_edge, 0}, cells);
  return mesh;
}

}  // namespace gonogo::sim
