// Ellipsoids: distances against a Lagrange solve in double precision, equal axes against the sphere, floors cut
// coarsely and finely against the plane, mass properties against a sum over small cubes.
#include "sim/shape/touch/convex.h"

#include <algorithm>
#include <vector>

#include "sim/shape/meshes.h"
#include "sim/shape/surface_library.h"
#include "sim/shape/touch/pairs.h"
#include "tests/sim/convex_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

Vec3 random_half(Draw& draw, double min, double max) {
  return {Real(draw.between(min, max)), Real(draw.between(min, max)), Real(draw.between(min, max))};
}

Shape shape_of(ShapeType type, const Vec3& size) {
  Shape s;
  s.type = type;
  s.size = size;
  return s;
}

std::vector<Touch> touches(const Shape& a, const Quat& qa, const Shape& b, const Quat& qb, const Vec3d& d,
                           const SurfaceView& surfaces = {}) {
  std::vector<Touch> found;
  visit_touches(ShapePair{.a = a, .b = b, .qa = qa, .qb = qb, .d = d, .envelope = Real(0.01), .surfaces = surfaces},
                [&](int, const Touch& t) { found.push_back(t); });
  return found;
}

}  // namespace

TEST_CASE("a sphere's gap to an ellipsoid is the distance of a Lagrange solve in double, inside and outside") {
  Draw draw(41);
  double worst = 0, off = 0;
  for (int i = 0; i < 20000; ++i) {
    const double min = i % 2 == 0 ? 0.1 : 0.004;  // aspect ratios up to 4 and to 100
    const Vec3 half = random_half(draw, min, 0.4);
    Vec3 p{Real(draw.between(-0.6, 0.6)), Real(draw.between(-0.6, 0.6)), Real(draw.between(-0.6, 0.6))};
    if (i % 7 == 0) p.x = 0;
    if (i % 11 == 0) p.z = 0;
    if (i % 77 == 1) p = {};
    const Gap g = sphere_ellipsoid_gap(p, half, 0.05f);
    const double expected = ellipsoid_distance(static_cast<Vec3d>(half), static_cast<Vec3d>(p)) - 0.05;
    INFO(half.x << " " << half.y << " " << half.z << " at " << p.x << " " << p.y << " " << p.z);
    worst = std::max(worst, std::abs(g.gap - expected));
    REQUIRE(std::abs(g.gap - expected) < 2e-6);
    REQUIRE(length(g.normal) == Approx(1).epsilon(1e-5));
    // Going back by the distance along the normal ends on the surface.
    const Vec3d foot = static_cast<Vec3d>(p) - static_cast<Vec3d>(g.normal) * (double(g.gap) + 0.05);
    off = std::max(off, std::abs(ellipsoid_distance(static_cast<Vec3d>(half), foot)));
  }
  CHECK(agrees("sphere and ellipsoid: largest error of the gap [m]", 0, worst, 2e-6));
  CHECK(agrees("sphere and ellipsoid: largest distance of the foot from the surface [m]", 0, off, 2e-6));
}

TEST_CASE("an ellipsoid with equal axes touches every shape as the sphere does") {
  Draw draw(42);
  const Shape others[] = {shape_of(ShapeType::sphere, {0.2f, 0, 0}), shape_of(ShapeType::capsule, {0.1f, 0.2f, 0}),
                          shape_of(ShapeType::cylinder, {0.2f, 0.15f, 0}), shape_of(ShapeType::box, {0.3f, 0.2f, 0.1f}),
                          shape_of(ShapeType::plane, {})};
  double gap = 0, normal = 0, point = 0;
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const Shape &other = others[i % 5], sphere = shape_of(ShapeType::sphere, {0.15f, 0, 0}),
                ball = shape_of(ShapeType::ellipsoid, {0.15f, 0.15f, 0.15f});
    const Quat q = draw.orientation(), qb = draw.orientation();
    Vec3d d = draw.direction() * draw.between(0.15, 0.5);
    if (other.type == ShapeType::plane)
      d = static_cast<Vec3d>(rotate(qb, {0.1f, 0.2f, Real(draw.between(0.14, 0.16))}));
    const std::vector<Touch> expected = touches(sphere, q, other, qb, d);
    if (expected.empty() || expected[0].gap < -0.003f) continue;
    const bool after = other.type == ShapeType::sphere || other.type == ShapeType::capsule;  // in the order of types
    const std::vector<Touch> found = after ? touches(other, qb, ball, q, -d) : touches(ball, q, other, qb, d);
    INFO("shape " << int(other.type) << ", case " << i);
    REQUIRE(found.size() == 1);
    const Touch t = after ? seen_from_other(found[0], -d) : found[0];
    gap = std::max(gap, std::abs(double(t.gap) - expected[0].gap));
    normal = std::max(normal, double(length(t.normal - expected[0].normal)));
    point = std::max(point, double(length(t.point - expected[0].point)));
    ++met;
  }
  CHECK(met > 500);
  CHECK(agrees("ellipsoid of equal axes: gap compared with the sphere's [m]", 0, gap, 2e-6));
  CHECK(agrees("ellipsoid of equal axes: normal compared with the sphere's", 0, normal, 2e-3));
  CHECK(agrees("ellipsoid of equal axes: point compared with the sphere's [m]", 0, point, 3e-4));
}

TEST_CASE("an ellipsoid has one contact with flat ground, however finely it is cut, and it is that with the plane") {
  Draw draw(43);
  double worst = 0;
  for (const int cells : {1, 2, 40}) {
    SurfaceLibrary library;
    const auto floor = std::make_shared<const TriangleMesh>(floor_mesh(2, cells));
    Shape mesh = shape_of(ShapeType::mesh, {reach_of(*floor), min_half_of(*floor), 0});
    mesh.surface = library.add(floor);
    for (int i = 0; i < 500; ++i) {
      const Shape body = shape_of(ShapeType::ellipsoid, random_half(draw, 0.05, 0.4));
      const Quat q = draw.orientation();
      const Vec3 low = rotate(q, -ellipsoid_support(body.size, rotate_back(q, {0, 0, 1})));
      // Every fourth with its lowest point on an inner edge, every eighth on a corner of the triangles.
      const double x = i % 4 == 0 ? 0.1 - low.x : draw.between(-1, 1),
                   y = i % 8 == 0 ? 0.2 - low.y : draw.between(-1, 1);
      const Vec3d d{x, y, -double(low.z) + draw.between(-0.004, 0.009)};
      const std::vector<Touch> on_plane = touches(body, q, shape_of(ShapeType::plane, {}), {}, d),
                               on_mesh = touches(body, q, mesh, {}, d, library.view());
      INFO(cells << " cells, case " << i);
      REQUIRE(on_plane.size() == 1);
      REQUIRE(on_mesh.size() == 1);
      worst = std::max({worst, std::abs(double(on_mesh[0].gap) - on_plane[0].gap),
                        double(length(on_mesh[0].point - on_plane[0].point)),
                        double(length(on_mesh[0].normal - on_plane[0].normal))});
    }
  }
  CHECK(agrees("ellipsoid on a floor of triangles compared with the plane [m]", 0, worst, 2e-6));
}

TEST_CASE("mass and moments of inertia of an ellipsoid are those of the small cubes inside of it") {
  SceneWorld w;
  const Vec3 half{0.3f, 0.2f, 0.11f};
  const double density = 2600;
  const BodyIndex b = w.add_ellipsoid({}, half, Real(density), 0);
  const int cells = 120;
  double mass = 0, xx = 0, yy = 0, zz = 0;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (int k = 0; k < cells; ++k) {
        const double x = (2 * i + 1.0) / cells - 1, y = (2 * j + 1.0) / cells - 1, z = (2 * k + 1.0) / cells - 1;
        if (x * x + y * y + z * z > 1) continue;
        const double m = density * 8.0 * half.x * half.y * half.z / (double(cells) * cells * cells);
        mass += m;
        xx += m * x * x * half.x * half.x;
        yy += m * y * y * half.y * half.y;
        zz += m * z * z * half.z * half.z;
      }
  const BodyMass& found = w.mass[std::size_t(b)];
  CHECK(1 / found.inverse_mass.x == Approx(mass).epsilon(2e-3));
  CHECK(1 / found.inverse_inertia_B.x == Approx(yy + zz).epsilon(2e-3));
  CHECK(1 / found.inverse_inertia_B.y == Approx(xx + zz).epsilon(2e-3));
  CHECK(1 / found.inverse_inertia_B.z == Approx(xx + yy).epsilon(2e-3));
}
