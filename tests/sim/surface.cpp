// Triangles of shapes against closed forms and against the gaps that contacts use.
#include "sim/io/capture.h"

#include <map>

#include "base/error.h"
#include "sim/shape/meshes.h"
#include "sim/shape/touch/gap.h"
#include "sim/shape/touch/touch.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

Shape shape(ShapeType type, const Vec3& size, int lugs = 0, Real thickness = 0) {
  Shape s;
  s.type = type;
  s.size = size;
  s.lug_count = lugs;
  s.lug_thickness = thickness;
  return s;
}

const Shape kBall = shape(ShapeType::sphere, {0.3f, 0, 0}), kBox = shape(ShapeType::box, {0.2f, 0.3f, 0.5f}),
            kCapsule = shape(ShapeType::capsule, {0.1f, 0.25f, 0}),
            kEgg = shape(ShapeType::ellipsoid, {0.3f, 0.2f, 0.1f}), kRod = shape(ShapeType::cylinder, {0.15f, 0.4f, 0}),
            kDrum = shape(ShapeType::wheel, {0.4f, 0.1f, 0.02f}),
            kTyre = shape(ShapeType::wheel, {0.467f, 0.127f, 0.02f}, 24, 0.03f);

/// Volume enclosed by a closed surface [m^3], by the divergence theorem; negative when it is inside out.
double enclosed_volume(const Surface& surface) {
  double six_times = 0;
  for (const auto& [a, b, c] : surface.triangle) {
    const auto p = static_cast<Vec3d>(surface.point[a]), q = static_cast<Vec3d>(surface.point[b]),
               r = static_cast<Vec3d>(surface.point[c]);
    six_times += dot(p, cross(q, r));
  }
  return six_times / 6;
}

/// Edges of a closed surface are walked once in each direction, points at the same place counted as one.
bool is_closed(const Surface& s) {
  const auto place = [&](Index i) {
    const Vec3& p = s.point[i];
    return std::array{std::lround(p.x * 1e5f), std::lround(p.y * 1e5f), std::lround(p.z * 1e5f)};
  };
  std::map<std::array<std::array<long, 3>, 2>, int> walked;
  for (const auto& t : s.triangle)
    for (int k = 0; k < 3; ++k) {
      const auto from = place(t[k]), to = place(t[(k + 1) % 3]);
      if (from < to) walked[{from, to}] += 1;
      if (to < from) walked[{to, from}] -= 1;
    }
  for (const auto& [edge, balance] : walked)
    if (balance != 0) return false;
  return true;
}

}  // namespace

TEST_CASE("surfaces of solids are closed, face outward and enclose the closed-form volume") {
  // Cylinders and spheres of n segments are polyhedra inside the round shape: within (2 pi / n)^2 / 6 of its volume.
  const SurfaceDetail fine{400, 1};
  const double tolerance = 2e-4;
  for (const Shape& s : {kBall, kCapsule, kEgg, kRod, kBox, kDrum, kTyre}) CHECK(is_closed(surface_of(s, fine)));
  CHECK(enclosed_volume(surface_of(kBox, fine)) == Approx(8 * 0.2 * 0.3 * 0.5).epsilon(1e-6));
  CHECK(enclosed_volume(surface_of(kBall, fine)) == Approx(4.0 / 3 * kPi * 0.027).epsilon(tolerance));
  CHECK(enclosed_volume(surface_of(kEgg, fine)) == Approx(4.0 / 3 * kPi * 0.006).epsilon(tolerance));
  CHECK(enclosed_volume(surface_of(kCapsule, fine)) == Approx(kPi * 0.01 * (0.5 + 4.0 / 3 * 0.1)).epsilon(tolerance));
  CHECK(enclosed_volume(surface_of(kRod, fine)) == Approx(kPi * 0.0225 * 0.8).epsilon(tolerance));
  SceneWorld w;
  Shape mesh = shape(ShapeType::mesh, {});
  mesh.surface = w.add_mesh(box_mesh({0.2f, 0.3f, 0.5f}, 2));
  CHECK(is_closed(surface_of(w, mesh)));
  CHECK(enclosed_volume(surface_of(w, mesh)) == Approx(8 * 0.2 * 0.3 * 0.5).epsilon(1e-6));
  const double drum = kPi * 0.4 * 0.4 * 0.2, tyre = kPi * 0.467 * 0.467 * 0.254;
  CHECK(enclosed_volume(surface_of(kDrum, fine)) == Approx(drum).epsilon(tolerance));
  // Lugs are boxes sunk into the rim; the sum counts their feet twice.
  CHECK(enclosed_volume(surface_of(kTyre, fine)) == Approx(tyre + 24 * 0.04 * 0.254 * 0.03).epsilon(tolerance));
}

TEST_CASE("normals are of length one and point out of the triangles they belong to") {
  for (const Shape& s : {kBall, kCapsule, kEgg, kRod, kBox, kTyre, shape(ShapeType::plane, {})}) {
    const Surface surface = surface_of(s, {s.type == ShapeType::ellipsoid ? 200 : 48, 1});  // its rim is sharp
    for (const Vec3& n : surface.normal) CHECK(length(n) == Approx(1).epsilon(1e-6));
    for (const auto& [a, b, c] : surface.triangle) {
      const Vec3 face = cross(surface.point[b] - surface.point[a], surface.point[c] - surface.point[a]);
      for (const Index corner : {a, b, c}) CHECK(dot(face, surface.normal[corner]) > 0.99f * length(face) - 1e-9f);
    }
  }
}

TEST_CASE("no point of a drawn wheel or box is outside the shape that contacts see") {
  const Surface tyre = surface_of(kTyre), box = surface_of(kBox);
  int on_lugs = 0;
  for (const Vec3& p : tyre.point) {
    Real nearest = sphere_cylinder_gap(p, kTyre.size.x, kTyre.size.y, 0).gap;
    for (int k = 0; k < kTyre.lug_count; ++k) nearest = std::min(nearest, sphere_lug_gap(p, kTyre, k, 0).gap);
    CHECK(nearest <= 1e-6f);
    on_lugs += sphere_cylinder_gap(p, kTyre.size.x, kTyre.size.y, 0).gap > 0.019f;
  }
  CHECK(on_lugs == 24 * 12);  // four outer corners of every lug, three sides meet at each
  for (const Vec3& p : box.point) CHECK(std::fabs(sphere_box_gap(p, kBox.size, 0).gap) < 1e-6f);
}

TEST_CASE("capsules and cylinders lie along their y axis") {
  for (const Shape& s : {kCapsule, kRod}) {
    const bool round = s.type == ShapeType::capsule;
    Real reach = 0;
    for (const Vec3& p : surface_of(s).point) {
      const Real beyond = std::max(std::fabs(p.y) - s.size.y, Real(0));
      const Real from_axis = std::sqrt(p.x * p.x + p.z * p.z + (round ? beyond * beyond : Real(0)));
      CHECK(from_axis <= s.size.x * 1.00001f);
      reach = std::max(reach, std::fabs(p.y));
    }
    CHECK(reach == Approx(s.size.y + (round ? s.size.x : Real(0))));
  }
}

TEST_CASE("meshes and heightfields are drawn where contacts meet them") {
  Draw draw(71);
  Heightfield field;
  field.name = "rough";
  field.nx = 6;
  field.ny = 5;
  field.spacing_x = 0.3f;
  field.spacing_y = 0.2f;
  for (int k = 0; k < field.nx * field.ny; ++k) field.height.push_back(Real(draw.between(-0.05, 0.05)));
  for (const ShapeType type : {ShapeType::mesh, ShapeType::heightfield}) {
    SceneWorld w;
    w.gravity = {};
    w.origin = {-2, -2, -2};
    w.size = {4, 4, 4};
    Shape s = shape(type, {});
    s.surface = type == ShapeType::mesh ? w.add_mesh(tyre_mesh(kTyre, 4)) : w.add_heightfield(field);
    s.body = w.add_body({{0.1, -0.2, 0.3}, about_x(0.4), {}, {}}, fixed_body());
    s.turn_B = about_y(0.7);
    s.offset_B = {0.05f, 0.1f, -0.02f};
    w.add_shape(s);
    const Surface surface = surface_of(w, s);
    CHECK(surface.triangle.size() == (type == ShapeType::mesh ? w.mesh[0]->triangle.size() : 2 * 5 * 4));
    const Quat turn = shape_orientation(s, w.body[0].orientation);
    // A small sphere on the middle of every drawn triangle, in a group of their own.
    const Real radius = 0.004f;
    std::vector<Vec3> normal;
    for (const auto& [a, b, c] : surface.triangle) {
      normal.push_back(rotate(turn, surface.normal[a]));
      const Vec3 middle = (surface.point[a] + surface.point[b] + surface.point[c]) * (Real(1) / 3);
      const Vec3 off = rotate(turn, middle) + normal.back() * radius;
      w.add_sphere(centre_of(s, w.body[0]) + static_cast<Vec3d>(off), radius, 1000, 0);
      w.shape.back().group = 7;
    }
    const auto simulation = simulate(Backend::cpu, w, {});
    simulation->advance(1);
    std::vector<int> found(w.body.size());
    for (const Contact& c : simulation->contacts(0)) {
      const bool sphere_first = c.body_b == 0;
      const BodyIndex ball = sphere_first ? c.body_a : c.body_b;
      const Vec3 n = sphere_first ? c.normal : -c.normal;
      if (dot(n, normal[std::size_t(ball) - 1]) < 0.99999f) continue;  // a neighbour across a valley
      CHECK(std::fabs(c.gap) < 1e-6f);
      ++found[std::size_t(ball)];
    }
    for (std::size_t b = 1; b < found.size(); ++b) CHECK(found[b] == 1);
  }
}

TEST_CASE("a plane is drawn as a square of the size asked for, seen from above") {
  const Surface s = surface_of(shape(ShapeType::plane, {}), {48, 2.5f});
  REQUIRE(s.point.size() == 4);
  REQUIRE(s.triangle.size() == 2);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(std::fabs(s.point[i].x) == 2.5f);
    CHECK(std::fabs(s.point[i].y) == 2.5f);
    CHECK(s.point[i].z == 0);
    CHECK(s.normal[i].z == 1);
  }
}

TEST_CASE("fewer than three segments around a turn are refused") {
  CHECK_THROWS_AS(surface_of(kBall, {2, 1}), InputError);
}
