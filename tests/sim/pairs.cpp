// Contacts of pairs of shapes against signed distances found by sampling directions, and their manifolds against what
// rests on a plane.
#include "sim/shape/touch/pairs.h"

#include <set>
#include <string>

#include "sim/scene/check_scene.h"
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

std::vector<Found> touches(const Shape& a, const Quat& qa, const Shape& b, const Quat& qb, const Vec3d& d,
                           Real envelope) {
  std::vector<Found> found;
  visit_touches(ShapePair{.a = a, .b = b, .qa = qa, .qb = qb, .d = d, .envelope = envelope, .surfaces = {}},
                [&](int feature, const Touch& t) {
                  found.push_back({feature, t});
                });
  return found;
}

Shape random_shape(ShapeType type, Draw& draw) {
  Shape s;
  s.type = type;
  s.size = {Real(draw.between(0.1, 0.4)), Real(draw.between(0.1, 0.4)), Real(draw.between(0.1, 0.4))};
  if (type == ShapeType::wheel) {
    s.size.z = Real(draw.between(0.02, 0.05));
    s.lug_count = 8 + draw.below(9);
    s.lug_thickness = Real(draw.between(0.02, 0.05));
  }
  return s;
}

double distance_of_parts(const std::vector<Body>& a, const std::vector<Body>& b) {
  double best = 1e300;
  for (const Body& p : a)
    for (const Body& q : b)
      if (length(p.centre - q.centre) < 2) best = std::min(best, signed_distance(p, q));
  return best;
}

double distance_to(const std::vector<Body>& list, const Vec3d& point) {
  double best = 1e300;
  for (const Body& p : list) best = std::min(best, p.distance(point));
  return best;
}

/// How far b must lie from a along `direction` for their signed distance to be `target` [m].
double place(const Shape& a, const Quat& qa, const Shape& b, const Quat& qb, const Vec3d& direction, double target) {
  const double both = double(bounding_radius(a)) + bounding_radius(b);
  double apart = both + target;
  const std::vector<Body> other = parts(b, {}, qb);
  for (int i = 0; i < 40; ++i) {
    const double now = distance_of_parts(parts(a, direction * apart, qa), other);
    if (now - target < 1e-7) break;
    apart -= now - target;  // the distance changes no faster than the bodies move
  }
  return apart;
}

constexpr Real kEnvelope = 0.01f;

void check_pair(ShapeType type_a, ShapeType type_b, int cases, std::uint64_t seed) {
  Draw draw(seed);
  double worst = 0;
  for (int i = 0; i < cases; ++i) {
    const Shape a = random_shape(type_a, draw), b = random_shape(type_b, draw);
    const Quat qa = draw.orientation(), qb = draw.orientation();
    const Vec3d direction = draw.direction();
    const double target = draw.between(-0.003, 0.008), apart = place(a, qa, b, qb, direction, target);
    const std::vector<Body> as = parts(a, direction * apart, qa), bs = parts(b, {}, qb);
    const double expected = distance_of_parts(as, bs);
    const std::vector<Found> found = touches(a, qa, b, qb, direction * apart, kEnvelope);
    INFO(int(type_a) << " against " << int(type_b) << ", case " << i << ": " << found.size() << " contacts, distance "
                     << expected);
    REQUIRE(!found.empty());
    double least = 1e300;
    std::set<int> names;
    for (const auto& [feature, t] : found) {
      least = std::min(least, double(t.gap));
      REQUIRE(names.insert(feature).second);
      REQUIRE(length(t.normal) == Approx(1).epsilon(1e-5));
      REQUIRE(t.gap < kEnvelope);
      // Midway: no further from either surface than half of the gap. Where rims and edges pass each other at a small
      // angle the point is good to a few millimetres of bodies of some decimetres.
      const Vec3d point = direction * apart + static_cast<Vec3d>(t.point);
      REQUIRE(std::abs(distance_to(as, point)) < 0.52 * std::abs(t.gap) + 6e-3);
      REQUIRE(std::abs(distance_to(bs, point)) < 0.52 * std::abs(t.gap) + 6e-3);
    }
    INFO("least gap " << least);
    // Flat faces are taken for up to a thousandth of the bodies' size worse than the best direction; not by ellipsoids.
    REQUIRE(std::abs(least - expected) < 7e-4);
    worst = std::max(worst, std::abs(least - expected));
  }
  const bool exact = type_b != ShapeType::wheel && (type_a == ShapeType::ellipsoid || type_b == ShapeType::ellipsoid);
  if (exact)
    CHECK(agrees("ellipsoid and " + std::string(name_of(type_a == ShapeType::ellipsoid ? type_b : type_a)) +
                     ": largest error of the gap [m]",
                 0, worst, 1e-6));
}

}  // namespace

TEST_CASE("contacts of convex pairs have the signed distance of the bodies and lie between their surfaces") {
  const ShapeType types[] = {ShapeType::sphere, ShapeType::capsule, ShapeType::ellipsoid, ShapeType::cylinder,
                             ShapeType::box};
  std::uint64_t seed = 900;
  for (const ShapeType a : types)
    for (const ShapeType b : types)
      if (a <= b) check_pair(a, b, 60, ++seed);
}

TEST_CASE("contacts of a wheel's cylinder and lugs with convex bodies have the least signed distance of the parts") {
  check_pair(ShapeType::sphere, ShapeType::wheel, 10, 921);
  check_pair(ShapeType::capsule, ShapeType::wheel, 10, 922);
  check_pair(ShapeType::ellipsoid, ShapeType::wheel, 10, 926);
  check_pair(ShapeType::cylinder, ShapeType::wheel, 10, 923);
  check_pair(ShapeType::box, ShapeType::wheel, 10, 924);
  check_pair(ShapeType::wheel, ShapeType::wheel, 2, 925);
}
