// Boxes, cylinders, wheels and meshes on meshes: against signed distances of the bodies that the meshes stand for,
// against the contacts of those bodies, and against brute force over triangles in double precision.
#include <algorithm>
#include <functional>
#include <memory>
#include <set>

#include "sim/shape/mesh_shapes.h"
#include "sim/shape/pairs.h"
#include "sim/shape/surface_library.h"
#include "tests/sim/convex_oracle.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

struct Found {
  int feature;
  Touch touch;
};

/// Shapes with the meshes that they refer to.
struct Shapes {
  SurfaceLibrary library;
  std::vector<std::shared_ptr<const TriangleMesh>> source;

  Shape mesh(TriangleMesh m) {
    check_mesh(m);
    source.push_back(std::make_shared<const TriangleMesh>(std::move(m)));
    Shape s;
    s.type = ShapeType::mesh;
    s.surface = library.add(source.back());
    s.size = {reach_of(*source.back()), least_half_of(*source.back()), 0};
    return s;
  }

  std::vector<Found> touches(const Shape& a, const Quat& qa, const Shape& b, const Quat& qb, const Vec3d& d,
                             double envelope) const {
    std::vector<Found> found;
    visit_touches(ShapePair{a, b, qa, qb, d, Real(envelope), library.view()}, [&](int feature, const Touch& t) {
      found.push_back({feature, t});
    });
    return found;
  }
};

/// The convex parts of a box, a cylinder or a wheel.
std::vector<Body> parts(const Shape& s, const Vec3d& centre, const Quat& q) {
  const Axes axes(q);
  const auto size = static_cast<Vec3d>(s.size);
  if (s.type != ShapeType::wheel) return {{s.type, size, centre, axes}};
  std::vector<Body> list{{ShapeType::cylinder, size, centre, axes}};
  for (int k = 0; k < s.lug_count; ++k) {
    const double angle = 2 * kPi * k / s.lug_count, c = std::cos(angle), si = std::sin(angle);
    Body lug{ShapeType::box, {size.z, size.y, 0.5 * s.lug_thickness}, centre, axes};
    lug.axes.x = axes.x * c + axes.z * si;
    lug.axes.z = axes.z * c - axes.x * si;
    lug.centre += lug.axes.x * size.x;
    list.push_back(lug);
  }
  return list;
}

double distance_of_parts(const std::vector<Body>& a, const std::vector<Body>& b) {
  double best = 1e300;
  for (const Body& p : a)
    for (const Body& q : b) {
      const double reach = length(p.size) + length(q.size);
      if (length(p.centre - q.centre) < std::min(best, 0.1) + reach) best = std::min(best, signed_distance(p, q));
    }
  return best < 1e299 ? best : 1;
}

double distance_to(const std::vector<Body>& list, const Vec3d& point) {
  double best = 1e300;
  for (const Body& p : list) best = std::min(best, p.distance(point));
  return best;
}

double least_gap(const std::vector<Found>& found) {
  double least = 1e30;
  for (const Found& f : found) least = std::min(least, double(f.touch.gap));
  return least;
}

constexpr double kEnvelope = 0.01;

/// A solid, and whether a mesh stands for it.
struct Kind {
  ShapeType type;
  bool mesh;
  int cells;
};

Shape random_solid(ShapeType type, Draw& draw) {
  Shape s;
  s.type = type;
  s.size = {Real(draw.between(0.1, 0.4)), Real(draw.between(0.1, 0.4)), Real(draw.between(0.1, 0.4))};
  if (type != ShapeType::wheel) return s;
  s.size.z = Real(draw.between(0.02, 0.05));
  s.lug_count = 5 + draw.below(4);
  s.lug_thickness = Real(draw.between(0.02, 0.05));
  return s;
}

TriangleMesh mesh_of(const Shape& s, int cells) {
  if (s.type == ShapeType::box) return box_mesh(s.size, cells);
  return s.type == ShapeType::wheel ? tyre_mesh(s, cells) : cylinder_mesh(s.size.x, s.size.y, cells);
}

/// The least gap of every case must be the signed distance of the bodies, and every contact lie between them.
void check_pair(const char* name, const Kind& kind_a, const Kind& kind_b, int cases, std::uint64_t seed,
                double tolerance) {
  Draw draw(seed);
  double worst = 0;
  for (int i = 0; i < cases; ++i) {
    Shapes shapes;
    const Shape solid_a = random_solid(kind_a.type, draw), solid_b = random_solid(kind_b.type, draw);
    const Shape a = kind_a.mesh ? shapes.mesh(mesh_of(solid_a, kind_a.cells)) : solid_a;
    const Shape b = kind_b.mesh ? shapes.mesh(mesh_of(solid_b, kind_b.cells)) : solid_b;
    const Quat qa = draw.orientation(), qb = draw.orientation();
    const Vec3d direction = draw.direction();
    const double target = draw.between(-0.003, 0.008);
    const std::vector<Body> other = parts(solid_b, {}, qb);
    double apart = 1.2, expected = 0;
    for (int k = 0; k < 60; ++k) {
      expected = distance_of_parts(parts(solid_a, direction * apart, qa), other);
      if (std::abs(expected - target) < 1e-7) break;
      apart -= expected - target;  // no faster than the bodies move
    }
    const std::vector<Body> one = parts(solid_a, direction * apart, qa);
    const std::vector<Found> found = shapes.touches(a, qa, b, qb, direction * apart, kEnvelope);
    INFO(name << ", case " << i << ": " << found.size() << " contacts, distance " << expected << ", least gap "
              << least_gap(found));
    REQUIRE(!found.empty());
    REQUIRE(found.size() <= std::size_t(kMostTouches));
    worst = std::max(worst, std::abs(least_gap(found) - expected));
    REQUIRE(std::abs(least_gap(found) - expected) < tolerance);
    std::set<int> names;
    for (const auto& [feature, t] : found) {
      REQUIRE(names.insert(feature).second);
      REQUIRE(length(t.normal) == Approx(1).epsilon(1e-5));
      const Vec3d point = direction * apart + static_cast<Vec3d>(t.point);
      REQUIRE(std::abs(distance_to(one, point)) < 0.52 * std::abs(t.gap) + tolerance + 2e-3);
      REQUIRE(std::abs(distance_to(other, point)) < 0.52 * std::abs(t.gap) + tolerance + 2e-3);
    }
  }
  CHECK(agrees(std::string(name) + ": largest error of the least gap [m]", 0, worst, tolerance));
}

constexpr Kind kBox{ShapeType::box, false, 0}, kCylinder{ShapeType::cylinder, false, 0},
    kWheel{ShapeType::wheel, false, 0};
constexpr Kind mesh_box(int cells) { return {ShapeType::box, true, cells}; }

}  // namespace

TEST_CASE("solids and meshes on the mesh of a box have the signed distance of the bodies, however finely it is cut") {
  check_pair("box on a mesh box", kBox, mesh_box(1), 60, 1, 2e-6);
  check_pair("box on a mesh box in 25 squares a side", kBox, mesh_box(5), 40, 2, 2e-6);
  check_pair("mesh box on a mesh box", mesh_box(1), mesh_box(1), 60, 3, 2e-6);
  check_pair("mesh box on a mesh box, cut", mesh_box(2), mesh_box(4), 40, 4, 2e-6);
  check_pair("cylinder on a mesh box", kCylinder, mesh_box(3), 60, 5, 5e-5);
  check_pair("wheel on a mesh box", kWheel, mesh_box(2), 40, 6, 5e-5);
}

TEST_CASE("solids and meshes on the mesh of a cylinder or tyre have the bodies' signed distance but for the chords") {
  // A chord of 1 / 96 of a turn lies within 5.4e-4 of the radius, at most 0.4 m, of its arc.
  const Kind cylinder{ShapeType::cylinder, true, 96}, tyre{ShapeType::wheel, true, 20};
  check_pair("box on a mesh cylinder", kBox, cylinder, 40, 7, 2.2e-4);
  check_pair("cylinder on a mesh cylinder", kCylinder, cylinder, 40, 8, 2.8e-4);
  check_pair("mesh cylinder on a mesh cylinder", cylinder, cylinder, 30, 9, 4.4e-4);
  check_pair("box on a tyre", kBox, tyre, 15, 10, 2.2e-4);
  check_pair("tyre on a mesh box", tyre, mesh_box(1), 15, 11, 2.2e-4);
  check_pair("wheel on a tyre", kWheel, tyre, 6, 12, 2.2e-4);
}
