// Bodies of every shape at rest: forces, moments and heights follow from statics.
#include <cmath>
#include <string>

#include "sim/shape/touch/touch.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

SceneWorld ground(double mu) {
  SceneWorld w;
  w.origin = {-5, -5, -1};
  w.size = {10, 10, 5};
  w.set_law(0, 0, {Real(mu), 0, 0});
  add_plane(w);
  return w;
}

Shape shape_of(ShapeType type, const Vec3& size) {
  Shape s;
  s.type = type;
  s.size = size;
  return s;
}

BodyIndex add_body(SceneWorld& w, Shape shape, const Vec3d& at, const Quat& q, double mass, const Vec3& inertia) {
  shape.body = w.add_body({at, q, {}, {}}, solid(Real(mass), inertia));
  w.add_shape(shape);
  return shape.body;
}

/// After a second at rest: weight on the ground, place and orientation kept.
void check_rest(const SceneWorld& w, const std::string& name, double weight) {
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, w, settings_with(60));
    advance_for(*simulation, 1);
    const std::string label = name + ", " + name_of(backend);
    CHECK(agrees(label + ": force on the ground [N]", -weight, simulation->contact_force(0, 0).z, 0.01 * weight));
    double drift = 0, turned = 0;
    const auto bodies = simulation->bodies(0);
    for (std::size_t b = 1; b < bodies.size(); ++b) {
      drift = std::max(drift, length(bodies[b].position - w.body[b].position));
      const Quat d = conjugate(w.body[b].orientation) * bodies[b].orientation;
      turned = std::max(turned, 2 * std::sqrt(double(d.x) * d.x + double(d.y) * d.y + double(d.z) * d.z));
    }
    CHECK(agrees(label + ": drift [m]", 0, drift, 2e-5));
    CHECK(agrees(label + ": turn [rad]", 0, turned, 1e-4));
    CHECK(simulation->report(0).flags == 0);
  }
}

constexpr double kMass = 40;
const Quat kOnItsSide{}, kUpright = about_x(kPi / 2);  // axis along y; along z

}  // namespace

TEST_CASE("bodies of every shape rest on a plane and carry their weight") {
  const Vec3 inertia{1, 1.5f, 0.8f};
  struct Case {
    const char* name;
    Shape shape;
    Quat q;
    double height;
  };
  Shape wheel = shape_of(ShapeType::wheel, {0.45f, 0.12f, 0});
  Shape lugged = shape_of(ShapeType::wheel, {0.45f, 0.12f, 0.02f});
  lugged.lug_count = 24;
  lugged.lug_thickness = 0.02f;
  const double low_lug = 0.47;  // a lug points straight down: quarter turns hold six of the 24
  const Case cases[] = {
      {"capsule lying", shape_of(ShapeType::capsule, {0.1f, 0.3f, 0}), kOnItsSide, 0.1},
      {"ellipsoid on its flattest side", shape_of(ShapeType::ellipsoid, {0.3f, 0.2f, 0.1f}), {}, 0.1},
      {"cylinder on its side", shape_of(ShapeType::cylinder, {0.2f, 0.3f, 0}), kOnItsSide, 0.2},
      {"cylinder on its flat face", shape_of(ShapeType::cylinder, {0.2f, 0.3f, 0}), kUpright, 0.3},
      {"box", shape_of(ShapeType::box, {0.2f, 0.3f, 0.1f}), {}, 0.1},
      {"wheel without lugs", wheel, {}, 0.45},
      {"lugged wheel", lugged, {}, low_lug},
  };
  for (const Case& c : cases) {
    SceneWorld w = ground(0.6);
    add_body(w, c.shape, {0.3, -0.2, c.height}, c.q, kMass, inertia);
    check_rest(w, c.name, kMass * kGravity);
  }
}

TEST_CASE("stacks of different shapes rest on each other and carry their weight") {
  SceneWorld boxes = ground(0.6);
  const Vec3 half{0.15f, 0.2f, 0.1f};
  for (int k = 0; k < 4; ++k) add_box(boxes, {{0.02 * (k % 2), 0, 0.1 + 0.2 * k}, {}, {}, {}}, half, 10);
  check_rest(boxes, "stack of four boxes", 40 * kGravity);

  SceneWorld turned = ground(0.6);
  add_box(turned, {{0, 0, 0.1}, {}, {}, {}}, half, 10);
  add_box(turned, {{0, 0, 0.3}, {Real(std::cos(0.4)), 0, 0, Real(std::sin(0.4))}, {}, {}}, half, 10);
  check_rest(turned, "box turned on a box", 20 * kGravity);

  SceneWorld drum = ground(0.6);
  add_box(drum, {{0, 0, 0.1}, {}, {}, {}}, {0.4f, 0.4f, 0.1f}, 20);
  add_body(drum, shape_of(ShapeType::cylinder, {0.15f, 0.2f, 0}), {0.1, 0, 0.4}, kUpright, 10, {0.3f, 0.3f, 0.3f});
  add_box(drum, {{0.1, 0, 0.65}, {}, {}, {}}, {0.2f, 0.1f, 0.05f}, 5);
  check_rest(drum, "box on a standing cylinder on a box", 35 * kGravity);

  SceneWorld lying = ground(0.6);
  add_box(lying, {{0, 0, 0.1}, {}, {}, {}}, {0.4f, 0.4f, 0.1f}, 20);
  add_body(lying, shape_of(ShapeType::cylinder, {0.15f, 0.2f, 0}), {0.1, 0, 0.35}, {}, 10, {0.3f, 0.3f, 0.3f});
  add_body(lying, shape_of(ShapeType::capsule, {0.05f, 0.2f, 0}), {-0.2, 0, 0.25}, {}, 3, {0.1f, 0.1f, 0.1f});
  check_rest(lying, "cylinder and capsule lying on a box", 33 * kGravity);
}

TEST_CASE("an overhanging box rests while its centre of mass is supported and tips beyond") {
  for (const Backend backend : backends())
    for (const double over : {0.9, 1.1}) {  // overhang of the centre in half lengths of the base
      SceneWorld w = ground(0.8);
      add_box(w, {{0, 0, 0.1}, {}, {}, {}}, {0.2f, 0.2f, 0.1f}, 1000);
      const BodyIndex b = add_box(w, {{0.2 * over, 0, 0.25}, {}, {}, {}}, {0.3f, 0.2f, 0.05f}, 2);
      const auto simulation = simulate(backend, w, settings_with(100));
      advance_for(*simulation, 0.6);
      const double tilt = 2 * std::asin(double(simulation->body(0, b).orientation.y));
      INFO("overhang " << over << ", tilt " << tilt);
      if (over < 1)
        CHECK(std::abs(tilt) < 1e-3);
      else
        CHECK(tilt > 0.05);
    }
}

TEST_CASE("the ends of a lying cylinder share an eccentric load by the law of the lever") {
  // A box of the same mass rests on the cylinder's end through a body of two shapes: the centre of mass is at 0.1 m of
  // 0.3 m, so the ends carry 2/3 and 1/3.
  for (const Backend backend : backends()) {
    SceneWorld w = ground(0.6);
    Shape cylinder = shape_of(ShapeType::cylinder, {0.2f, 0.3f, 0});
    cylinder.offset_B = {0, -0.1f, 0};  // the centre of mass lies 0.1 m towards +y
    add_body(w, cylinder, {0, 0.1, 0.2}, {}, kMass, {2, 1, 2});
    const auto simulation = simulate(backend, w, settings_with(200));
    advance_for(*simulation, 0.5);
    double at_end[2] = {0, 0};
    const auto contacts = simulation->contacts(0);
    const auto impulses = simulation->impulses(0);
    for (std::size_t i = 0; i < contacts.size(); ++i)
      at_end[contacts[i].arm_a.y > 0 ? 1 : 0] += impulses[i].linear.z / simulation->settings().step;
    CHECK(agrees("lying cylinder, load at the far end [N]", kMass * kGravity / 3, at_end[0], 0.01 * kMass * kGravity));
    CHECK(agrees("lying cylinder, load at the near end [N]", kMass * kGravity * 2 / 3, at_end[1],
                 0.01 * kMass * kGravity));
  }
}

TEST_CASE("a wheel pushed against a kerb lifts off when the push exceeds the moment of its weight") {
  // About the kerb's edge at height k: F (r - k) > m g sqrt(r^2 - (r - k)^2).
  const double r = 0.45, kerb = 0.15, mass = 50;
  const double limit = mass * kGravity * std::sqrt(r * r - (r - kerb) * (r - kerb)) / (r - kerb);
  for (const Backend backend : backends())
    for (const double share : {0.97, 1.03}) {
      SceneWorld w = ground(0);
      // Gravity leans: the horizontal part is the push through the wheel's centre.
      w.gravity = {Real(share * limit / mass), 0, Real(-kGravity)};
      const double edge = std::sqrt(r * r - (r - kerb) * (r - kerb));
      const BodyIndex step = w.add_body({{edge + 0.5, 0, kerb - 0.5}, {}, {}, {}}, fixed_body());
      Shape box = shape_of(ShapeType::box, {0.5f, 0.5f, 0.5f});
      box.body = step;
      w.add_shape(box);
      BodyMass m = solid(Real(mass), {3, 5, 3});
      Shape wheel = shape_of(ShapeType::wheel, {Real(r), 0.12f, 0});
      wheel.body = w.add_body({{0, 0, r}, {}, {}, {}}, m);
      w.add_shape(wheel);
      const auto simulation = simulate(backend, w, settings_with(200));
      advance_for(*simulation, 0.4);
      const double lifted = simulation->body(0, wheel.body).position.z - r;
      INFO(name_of(backend) << " share " << share << " lifted " << lifted);
      if (share < 1)
        CHECK(std::abs(lifted) < 2e-4);
      else
        CHECK(lifted > 5e-3);
    }
}
