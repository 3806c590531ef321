// Boxes, cylinders, wheels and meshes on meshes: against signed distances of the bodies that the meshes stand for,
// against the contacts of those bodies, and against brute force over triangles in double precision.
#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <set>

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
    s.size = {reach_of(*source.back()), min_half_of(*source.back()), 0};
    return s;
  }

  std::vector<Found> touches(const Shape& a, const Quat& qa, const Shape& b, const Quat& qb, const Vec3d& d,
                             double envelope) const {
    std::vector<Found> found;
    visit_touches(
        ShapePair{.a = a, .b = b, .qa = qa, .qb = qb, .d = d, .envelope = Real(envelope), .surfaces = library.view()},
        [&](int feature, const Touch& t) {
          found.push_back({feature, t});
        });
    return found;
  }
};

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

double min_gap(const std::vector<Found>& found) {
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

Shape solid_box(const Vec3& half) {
  Shape s;
  s.type = ShapeType::box;
  s.size = half;
  return s;
}

TriangleMesh mesh_of(const Shape& s, int cells) {
  if (s.type == ShapeType::box) return box_mesh(s.size, cells);
  return s.type == ShapeType::wheel ? tyre_mesh(s, cells) : cylinder_mesh(s.size.x, s.size.y, cells);
}

struct Range {
  double low, high;
};
constexpr Range kNear{-0.003, 0.008}, kDeep{-0.02, -0.003};

/// The gap that is nearest to a distance.
double gap_near(const std::vector<Found>& found, double distance) {
  double best = 1e30;
  for (const Found& f : found)
    if (std::abs(f.touch.gap - distance) < std::abs(best - distance)) best = f.touch.gap;
  return best;
}

/// The least gap of every case must be the signed distance of the bodies, and every contact lie between them. Deep ones
/// may be pushed along other ways out as well.
void check_pair(const char* name, const Kind& kind_a, const Kind& kind_b, int cases, std::uint64_t seed,
                double tolerance, Range range = kNear) {
  Draw draw(seed);
  double worst = 0;
  for (int i = 0; i < cases; ++i) {
    Shapes shapes;
    const Shape solid_a = random_solid(kind_a.type, draw), solid_b = random_solid(kind_b.type, draw);
    const Shape a = kind_a.mesh ? shapes.mesh(mesh_of(solid_a, kind_a.cells)) : solid_a;
    const Shape b = kind_b.mesh ? shapes.mesh(mesh_of(solid_b, kind_b.cells)) : solid_b;
    const Quat qa = draw.orientation(), qb = draw.orientation();
    const Vec3d direction = draw.direction();
    const double target = draw.between(range.low, range.high);
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
              << min_gap(found));
    REQUIRE(!found.empty());
    REQUIRE(found.size() <= std::size_t(kMaxTouches));
    const double gap = range.low < kNear.low ? gap_near(found, expected) : min_gap(found);
    worst = std::max(worst, std::abs(gap - expected));
    REQUIRE(std::abs(gap - expected) < tolerance);
    std::set<int> names;
    for (const auto& [feature, t] : found) {
      REQUIRE(names.insert(feature).second);
      REQUIRE(length(t.normal) == Approx(1).epsilon(1e-5));
      if (range.low < kNear.low) continue;
      const Vec3d point = direction * apart + static_cast<Vec3d>(t.point);
      REQUIRE(std::abs(distance_to(one, point)) < 0.52 * std::abs(t.gap) + tolerance + 2e-3);
      REQUIRE(std::abs(distance_to(other, point)) < 0.52 * std::abs(t.gap) + tolerance + 2e-3);
    }
  }
  CHECK(agrees(std::string(name) + ": largest error of the least gap [m]", 0, worst, tolerance));
}

using Polygon = std::vector<std::pair<double, double>>;  // counterclockwise

double area_of(const Polygon& p) {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto &a = p[k], &b = p[(k + 1) % p.size()];
    sum += (a.first * b.second - b.first * a.second) / 2;
  }
  return sum;
}

/// What both rectangles cover (Sutherland & Hodgman 1974).
Polygon common_part(Polygon subject, const Polygon& clip) {
  for (std::size_t k = 0; k < clip.size(); ++k) {
    const auto &a = clip[k], &b = clip[(k + 1) % clip.size()];
    const auto side = [&](const std::pair<double, double>& p) {
      return (b.first - a.first) * (p.second - a.second) - (b.second - a.second) * (p.first - a.first);
    };
    Polygon left;
    for (std::size_t i = 0; i < subject.size(); ++i) {
      const auto &p = subject[i], &q = subject[(i + 1) % subject.size()];
      const double sp = side(p), sq = side(q);
      if (sp >= 0) left.push_back(p);
      if ((sp >= 0) == (sq >= 0)) continue;
      const double t = sp / (sp - sq);
      left.push_back({p.first + t * (q.first - p.first), p.second + t * (q.second - p.second)});
    }
    subject = left;
  }
  return subject;
}

Polygon hull_of(Polygon p) {
  std::sort(p.begin(), p.end());
  Polygon hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = hull.size();
    for (const auto& c : p) {
      while (hull.size() >= start + 2) {
        const auto &a = hull[hull.size() - 2], &b = hull.back();
        if ((b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first) > 0) break;
        hull.pop_back();
      }
      hull.push_back(c);
    }
    hull.pop_back();
    std::reverse(p.begin(), p.end());
  }
  return hull;
}

Polygon rectangle(const Vec3& half, double x, double y, double yaw) {
  Polygon p;
  for (const auto& [u, v] : Polygon{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const double a = u * half.x, b = v * half.y;
    p.push_back({x + a * std::cos(yaw) - b * std::sin(yaw), y + a * std::sin(yaw) + b * std::cos(yaw)});
  }
  return p;
}

double distance_of_segments(const Vec3d& p, const Vec3d& u, const Vec3d& q, const Vec3d& v) {
  const auto to_segment = [](const Vec3d& x, const Vec3d& from, const Vec3d& along) {
    const double t = std::clamp(dot(x - from, along) / dot(along, along), 0.0, 1.0);
    return length(x - from - along * t);
  };
  double best = std::min({to_segment(p, q, v), to_segment(p + u, q, v), to_segment(q, p, u), to_segment(q + v, p, u)});
  const Vec3d n = cross(u, v), w = q - p;
  const double area = dot(n, n), s = dot(cross(w, v), n) / area, t = dot(cross(w, u), n) / area;
  if (area > 0 && s >= 0 && s <= 1 && t >= 0 && t <= 1) best = std::min(best, std::abs(dot(w, n)) / std::sqrt(area));
  return best;
}

double distance_above(const Vec3d& p, const std::array<Vec3d, 3>& t) {
  const Vec3d n = cross(t[1] - t[0], t[2] - t[0]);
  for (int k = 0; k < 3; ++k)
    if (dot(cross(n, t[(k + 1) % 3] - t[k]), p - t[k]) < 0) return 1e300;
  return std::abs(dot(p - t[0], n)) / length(n);
}

using Triangles = std::vector<std::array<Vec3d, 3>>;

/// Of two surfaces that do not cut each other.
double distance_of_triangles(const Triangles& a, const Triangles& b, const Vec3d& d) {
  double best = 1e300;
  for (std::array<Vec3d, 3> s : a) {
    for (Vec3d& p : s) p += d;
    for (const auto& t : b) {
      if (length(s[0] - t[0]) > 0.65) continue;  // longer than two edges and what is looked for
      for (int i = 0; i < 3; ++i) {
        best = std::min({best, distance_above(s[i], t), distance_above(t[i], s)});
        for (int k = 0; k < 3; ++k)
          best = std::min(best, distance_of_segments(s[i], s[(i + 1) % 3] - s[i], t[k], t[(k + 1) % 3] - t[k]));
      }
    }
  }
  return best;
}

Triangles triangles_of(const TriangleMesh& m, const Quat& q) {
  const Axes axes(q);
  Triangles list;
  for (const auto& c : m.triangle) {
    std::array<Vec3d, 3> t;
    for (int k = 0; k < 3; ++k) t[k] = axes.out_of(static_cast<Vec3d>(m.vertex[c[k]]));
    list.push_back(t);
  }
  return list;
}

/// A beam along y whose section is an L with its inner corner at x = z = 0, 0.2 thick.
TriangleMesh angle_beam() {
  TriangleMesh m;
  m.name = "angle";
  const std::pair<Real, Real> outline[] = {{0, 0}, {0, 1}, {-0.2f, 1}, {-0.2f, -0.2f}, {1, -0.2f}, {1, 0}};  // x, z
  for (const Real y : {-1.0f, 1.0f})
    for (const auto& [x, z] : outline) m.vertex.push_back({x, y, z});
  for (Index k = 0; k < 6; ++k) {
    const Index next = (k + 1) % 6;
    m.triangle.push_back({k, k + 6, next + 6});
    m.triangle.push_back({k, next + 6, next});
    if (k == 0 || k == 5) continue;
    m.triangle.push_back({0, k, next});
    m.triangle.push_back({6, next + 6, k + 6});
  }
  return m;
}

constexpr Kind kBox{ShapeType::box, false, 0}, kEllipsoid{ShapeType::ellipsoid, false, 0},
    kCylinder{ShapeType::cylinder, false, 0}, kWheel{ShapeType::wheel, false, 0};
constexpr Kind mesh_box(int cells) { return {ShapeType::box, true, cells}; }

}  // namespace

TEST_CASE("solids and meshes on the mesh of a box have the signed distance of the bodies, however finely it is cut") {
  check_pair("box on a mesh box", kBox, mesh_box(1), 60, 1, 2e-6);
  check_pair("box on a mesh box in 25 squares a side", kBox, mesh_box(5), 40, 2, 2e-6);
  check_pair("ellipsoid on a mesh box", kEllipsoid, mesh_box(1), 100, 11, 2e-6);
  check_pair("ellipsoid on a mesh box in 25 squares a side", kEllipsoid, mesh_box(5), 60, 12, 2e-6);
  check_pair("mesh box on a mesh box", mesh_box(1), mesh_box(1), 60, 3, 2e-6);
  check_pair("mesh box on a mesh box, cut", mesh_box(2), mesh_box(4), 40, 4, 2e-6);
  check_pair("cylinder on a mesh box", kCylinder, mesh_box(3), 60, 5, 2e-6);
  check_pair("wheel on a mesh box", kWheel, mesh_box(2), 40, 6, 2e-6);
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

TEST_CASE(
    "a box on a box, either or both of triangles, touches at the corners of what their faces share, upwards only") {
  const Vec3 low_half{0.2f, 0.15f, 0.1f}, half{0.1f, 0.15f, 0.05f};
  Shapes shapes;
  Shape low = solid_box(low_half), top = solid_box(half);
  const Shape low_mesh[] = {shapes.mesh(box_mesh(low_half, 1)), shapes.mesh(box_mesh(low_half, 6))};
  const Shape top_mesh[] = {shapes.mesh(box_mesh(half, 1)), shapes.mesh(box_mesh(half, 5))};
  Draw draw(950);
  for (int i = 0; i < 600; ++i) {
    // Aligned sides, shifts of nothing or of rounding, overhangs of all sizes; all yaws.
    const double shifts[] = {0, 1e-7, 1e-6, 1e-5, 0.1, 0.3 - 3e-3, draw.between(0, 0.25)};
    const double x = shifts[draw.below(7)], y = draw.below(2) ? shifts[draw.below(5)] : 0;
    const double yaw = draw.below(2) ? 0 : draw.below(2) ? kPi / 2 : draw.between(0, kPi);
    const double gap = draw.below(3) ? draw.between(-1e-3, 2e-6) : 0;
    const Quat both = draw.below(2) ? Quat{} : draw.orientation(),
               spin{Real(std::cos(yaw / 2)), 0, 0, Real(std::sin(yaw / 2))};
    const Polygon shared = common_part(rectangle(half, x, y, yaw), rectangle(low_half, 0, 0, 0));
    const double area = area_of(shared);
    if (area < 2e-4) continue;  // as good as past the edge
    const Vec3d d = static_cast<Vec3d>(rotate(both, Vec3{Real(x), Real(y), Real(low_half.z + half.z + gap)}));
    for (int how = 0; how < 5; ++how) {
      const Shape& upper = how == 0 ? top : top_mesh[how % 2];
      const Shape& lower = how == 1 || how == 2 ? low : low_mesh[how / 3];
      const bool upper_first = upper.type <= lower.type;
      const std::vector<Found> found = upper_first ? shapes.touches(upper, both * spin, lower, both, d, 2e-3)
                                                   : shapes.touches(lower, both, upper, both * spin, -d, 2e-3);
      INFO("case " << i << " way " << how << " x " << x << " y " << y << " yaw " << yaw << " gap " << gap);
      Polygon points;
      for (const auto& [feature, t] : found) {
        const Vec3 n = rotate_back(both, upper_first ? t.normal : -t.normal);
        const Vec3 p = rotate_back(both, upper_first ? t.point + static_cast<Vec3>(d) : t.point);
        REQUIRE(n.z == Approx(1).margin(1e-5));
        REQUIRE(t.gap == Approx(gap).margin(2e-6));
        points.push_back({p.x, p.y});
      }
      REQUIRE(points.size() >= 3);
      REQUIRE(points.size() <= 40);
      REQUIRE(area_of(hull_of(points)) == Approx(area).margin(2e-5));
    }
  }
}

TEST_CASE("bodies that overlap by up to 2 cm have a contact along the shortest way out") {
  check_pair("box deep in a mesh box", kBox, mesh_box(1), 60, 13, 2e-6, kDeep);
  check_pair("mesh box deep in a mesh box", mesh_box(2), mesh_box(3), 40, 14, 2e-6, kDeep);
  check_pair("cylinder deep in a mesh box", kCylinder, mesh_box(2), 60, 15, 1e-4, kDeep);
  check_pair("wheel deep in a mesh box", kWheel, mesh_box(1), 10, 16, 1e-4, kDeep);
}

TEST_CASE("two tyres apart have the distance of their triangles, whichever comes first, in the same contacts") {
  Draw draw(951);
  Shape wheel = random_solid(ShapeType::wheel, draw);
  wheel.size = {0.3f, 0.1f, 0.04f};
  wheel.lug_count = 9;
  wheel.lug_thickness = 0.05f;
  const TriangleMesh source = tyre_mesh(wheel, 3);
  Shapes shapes;
  const Shape tyre = shapes.mesh(source);
  double worst = 0;
  for (int i = 0; i < 15; ++i) {
    const Quat qa = draw.orientation(), qb = draw.orientation();
    const Triangles a = triangles_of(source, qa), b = triangles_of(source, qb);
    const Vec3d direction = draw.direction();
    const double target = draw.between(1e-4, 0.008);
    double apart = 0.75, distance = 0;
    for (int k = 0; k < 25; ++k) {
      distance = std::min(distance_of_triangles(a, b, direction * apart), 0.2);
      if (std::abs(distance - target) < 1e-6) break;
      apart -= distance - target;
    }
    const auto found = shapes.touches(tyre, qa, tyre, qb, direction * apart, 0.01);
    const auto turned = shapes.touches(tyre, qb, tyre, qa, direction * -apart, 0.01);
    INFO("case " << i << ": distance " << distance << ", " << found.size() << " contacts");
    REQUIRE(!found.empty());
    worst = std::max(worst, std::abs(min_gap(found) - distance));
    REQUIRE(turned.size() == found.size());
    for (const Found& f : found) {
      const Touch other = seen_from_other(f.touch, direction * apart);
      const bool there = std::any_of(turned.begin(), turned.end(), [&](const Found& g) {
        return std::abs(g.touch.gap - other.gap) < 1e-6 && length(g.touch.normal - other.normal) < 1e-3 &&
               length(g.touch.point - other.point) < 1e-5;
      });
      REQUIRE(there);
    }
  }
  CHECK(agrees("tyre and tyre: largest error of the least gap [m]", 0, worst, 2e-6));
}

TEST_CASE("in a hollow corner of a mesh every body touches both walls, at the depth that it is in each") {
  Shapes shapes;
  const Shape beam = shapes.mesh(angle_beam());
  const Vec3 half{0.1f, 0.14f, 0.1f};
  Shape cylinder = solid_box(half), wheel = cylinder;
  cylinder.type = ShapeType::cylinder;
  wheel.type = ShapeType::wheel;
  wheel.size.z = 0.01f;
  for (const Shape& body :
       {solid_box(half), shapes.mesh(box_mesh(half, 1)), shapes.mesh(box_mesh(half, 3)), cylinder, wheel})
    for (const double into_wall : {0.0, 1e-5, 1e-3})
      for (const double into_floor : {0.0, 2e-5, 1.5e-3}) {
        const auto found = shapes.touches(body, {}, beam, {}, {0.1 - into_wall, 0.3, 0.1 - into_floor}, 2e-3);
        INFO(int(body.type) << " " << into_wall << " " << into_floor << ": " << found.size());
        double wall_low = 1, wall_high = -1, floor_low = 1, floor_high = -1;
        for (const auto& [feature, t] : found) {
          const bool wall = t.normal.x > 0.99f;
          REQUIRE((wall || t.normal.z > 0.99f));
          REQUIRE(t.gap == Approx(wall ? -into_wall : -into_floor).margin(1e-6));
          double &low = wall ? wall_low : floor_low, &high = wall ? wall_high : floor_high;
          low = std::min(low, double(t.point.y));
          high = std::max(high, double(t.point.y));
        }
        // Carried over the whole length on both.
        for (const double end : {wall_high, floor_high}) CHECK(end == Approx(0.14).margin(1e-5));
        for (const double end : {wall_low, floor_low}) CHECK(end == Approx(-0.14).margin(1e-5));
      }
}
