// Clumps alone: their geometry and inertia against counted points, and how they lie on a plane and on each other.
#include "terrain/bed/clump.h"

#include <algorithm>
#include <cmath>

#include "base/math/random.h"
#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::terrain;
using gonogo::test::agrees;

namespace {

bool inside(const Clump& c, const Vec3d& p) {
  return std::any_of(c.lobe.begin(), c.lobe.end(), [&](const Vec3d& x) { return length(p - x) < c.lobe_radius; });
}

/// Volume, centre and second moments of a clump from random points in the cube around it.
struct CountedSolid {
  double volume = 0;
  Vec3d centre, square, product;  // means over the solid of r, (xx, yy, zz) and (xy, xz, yz)
};

CountedSolid counted(const Clump& c, int points) {
  CountedSolid m;
  int hits = 0;
  for (int i = 0; i < points; ++i) {
    const auto at = [&](int axis) { return c.reach * (2 * random_unit(5, std::uint64_t(axis), std::uint64_t(i)) - 1); };
    const Vec3d p{at(0), at(1), at(2)};
    if (!inside(c, p)) continue;
    ++hits;
    m.centre += p;
    m.square += scale(p, p);
    m.product += Vec3d{p.x * p.y, p.x * p.z, p.y * p.z};
  }
  m.volume = 8 * c.reach * c.reach * c.reach * hits / points;
  for (Vec3d* v : {&m.centre, &m.square, &m.product}) *v *= 1.0 / hits;
  return m;
}

/// A level plane under one kind of grain.
sim::SceneWorld floor_world(double friction) {
  sim::SceneWorld w = test::open_world({Real(friction), 0, 0});
  test::add_plane(w);
  return w;
}

sim::StepSettings fine_steps() {
  sim::StepSettings s = test::settings_with(200);
  s.step = Real(1e-3);
  return s;
}

}  // namespace

TEST_CASE(
    "a clump has the volume of its sphere, its centre of mass at the origin, and the counted moments of inertia") {
  for (const GrainShape shape : {GrainShape::sphere, GrainShape::pair, GrainShape::trefoil}) {
    const double radius = 0.7;
    const Clump c = clump_of(shape, radius);
    const CountedSolid m = counted(c, 400000);
    const std::string name = name_of(shape);
    const double square = radius * radius;
    // Standard errors of 200,000 points inside: 0.2 % of the volume, 0.001 of a squared radius.
    CHECK(agrees(name + ": counted volume over the sphere's", 1, m.volume / (4 * kPi / 3 * square * radius), 0.01));
    CHECK(c.volume == Approx(4 * kPi / 3 * square * radius).epsilon(1e-12));
    CHECK(agrees(name + ": centre of mass [radii]", 0, length(m.centre) / radius, 0.005));
    CHECK(agrees(name + ": products of inertia [radii^2]", 0, length(m.product) / square, 0.005));
    const Vec3d inertia{m.square.y + m.square.z, m.square.x + m.square.z, m.square.x + m.square.y};
    CHECK(agrees(name + ": moment about x [radii^2]", inertia.x / square, c.inertia_per_mass.x / square, 0.005));
    CHECK(agrees(name + ": moment about y [radii^2]", inertia.y / square, c.inertia_per_mass.y / square, 0.005));
    CHECK(agrees(name + ": moment about z [radii^2]", inertia.z / square, c.inertia_per_mass.z / square, 0.005));
  }
}

TEST_CASE("lobes lie as their names say, and the reach is that of the farthest") {
  const Clump pair = clump_of(GrainShape::pair, 1), trefoil = clump_of(GrainShape::trefoil, 1);
  REQUIRE(pair.lobe.size() == 2);
  CHECK(length(pair.lobe[0] - pair.lobe[1]) == Approx(pair.lobe_radius));
  REQUIRE(trefoil.lobe.size() == 3);
  for (int k = 0; k < 3; ++k)
    CHECK(length(trefoil.lobe[k] - trefoil.lobe[(k + 1) % 3]) == Approx(std::sqrt(3.0) * trefoil.lobe_radius));
  CHECK(pair.reach == Approx(1.5 * pair.lobe_radius));
  CHECK(trefoil.reach == Approx(2 * trefoil.lobe_radius));
  CHECK(clump_of(GrainShape::sphere, 0.3).lobe_radius == 0.3);
}

TEST_CASE("shapes have names, and another name is refused with these") {
  for (const std::string& name : grain_shape_names()) CHECK(name_of(grain_shape_of(name)) == name);
  refused([] { grain_shape_of("cube"); }, "none of sphere, pair, trefoil");
}

TEST_CASE("orientations drawn at random are uniform") {
  Vec3d mean, square;
  constexpr int draws = 20000;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const auto u = [&](std::uint64_t k) { return random_unit(3, 1, 3 * i + k); };
    const auto axis = static_cast<Vec3d>(rotate(random_orientation(u(0), u(1), u(2)), {0.6f, 0, 0.8f}));
    mean += axis * (1.0 / draws);
    square += scale(axis, axis) * (1.0 / draws);
  }
  CHECK(length(mean) < 0.02);
  for (const double s : {square.x, square.y, square.z}) CHECK(agrees("mean square of a direction", 1.0 / 3, s, 0.01));
}

TEST_CASE("the mirror image of a clump has the mirror images of its lobes") {
  for (const GrainShape shape : {GrainShape::pair, GrainShape::trefoil}) {
    const Quat turn = random_orientation(0.3, 0.61, 0.87);
    const auto original = lobes_of(shape, {{{}, 1, turn}}), image = lobes_of(shape, {{{}, 1, mirrored(shape, turn)}});
    for (const Grain& a : original) {
      const Vec3d want{a.position.x, -a.position.y, a.position.z};
      CHECK(std::any_of(image.begin(), image.end(), [&](const Grain& b) { return length(b.position - want) < 1e-6; }));
    }
  }
}

TEST_CASE("a clump let go askew over a plane comes to lie flat on it and presses with its weight") {
  const double radius = 0.05, density = 2000;
  for (const sim::Backend backend : test::backends())
    for (const GrainShape shape : {GrainShape::pair, GrainShape::trefoil}) {
      const Clump c = clump_of(shape, radius);
      sim::SceneWorld w = floor_world(0.5);
      const sim::BodyIndex b =
          add_grain(w, shape, {{0, 0, 1.1 * c.reach}, radius, test::about_y(0.5) * test::about_x(0.4)}, density, 0);
      CHECK(double(w.mass[std::size_t(b)].inverse_inertia_B.z) ==
            Approx(1 / (density * c.volume * c.inertia_per_mass.z)).epsilon(1e-5));
      const auto s = test::simulate(backend, w, fine_steps());
      s->advance(2500);
      const std::string name = name_of(shape) + " on " + test::name_of(backend);
      CHECK(agrees(name + ": height of the centre of mass [lobe radii]", 1, s->body(0, b).position.z / c.lobe_radius,
                   0.01));
      CHECK(agrees(name + ": force of the plane [weights]", 1,
                   s->contact_force(0, b).z / (density * c.volume * kGravity), 0.01));
      // One contact per lobe, and none between the lobes of the clump.
      CHECK(s->contacts(0).size() == c.lobe.size());
      CHECK(double(length(s->body(0, b).velocity)) < 1e-3);
    }
}

TEST_CASE("a trefoil lies on another: lobes of two bodies touch, lobes of one body never do") {
  const double radius = 0.05;
  const Clump c = clump_of(GrainShape::trefoil, radius);
  for (const sim::Backend backend : test::backends()) {
    sim::SceneWorld w = floor_world(0.5);
    // The upper one is turned by half a turn: each of its lobes lies between two lobes of the lower one or beside one.
    const sim::BodyIndex low = add_grain(w, GrainShape::trefoil, {{0, 0, c.lobe_radius}, radius, {}}, 2000, 0);
    const sim::BodyIndex high =
        add_grain(w, GrainShape::trefoil, {{0, 0, 3 * c.lobe_radius}, radius, {0, 0, 0, 1}}, 2000, 0);
    const auto s = test::simulate(backend, w, fine_steps());
    s->advance(1500);
    const double weight = 2000 * c.volume * kGravity;
    int between = 0;
    for (const sim::Contact& k : s->contacts(0)) {
      CHECK(k.body_a != k.body_b);
      between += std::min(k.body_a, k.body_b) == low && std::max(k.body_a, k.body_b) == high;
    }
    CHECK(between >= 3);
    CHECK(agrees("force that carries the upper trefoil [weights]", 1, s->contact_force(0, high).z / weight, 0.02));
    CHECK(
        agrees("force on the lower one, plane less the upper [weights]", 1, s->contact_force(0, low).z / weight, 0.02));
    CHECK(s->body(0, high).position.z < 3 * c.lobe_radius);  // sunk into the hollows
    CHECK(s->body(0, high).position.z > 1.5 * c.lobe_radius);
    CHECK(double(length(s->body(0, high).velocity)) < 2e-3);
  }
}
