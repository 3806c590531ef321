#include <cmath>
#include <limits>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Worlds 0 and 1 alike: two spheres at rest on a plane.
Scene two_worlds() {
  SceneWorld w;
  w.size = {1, 1, 1};
  w.set_law(0, 0, {Real(0.5), 0, 0});
  add_plane(w);
  w.add_sphere({0.3, 0.5, 0.05}, 0.05f, 2000, 0);
  w.add_sphere({0.6, 0.5, 0.05}, 0.05f, 2000, 0);
  return {w, w};
}

}  // namespace

TEST_CASE("bodies that behave raise no flag") {
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, two_worlds(), {}, 1);
    simulation->advance(100);
    CHECK(simulation->report(0).flags == 0);
    CHECK(simulation->report(1).flags == 0);
  }
}

TEST_CASE("a velocity that is not a number is flagged in its world, and the batch goes on") {
  for (const Backend backend : backends())
    for (const Real bad : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
      const auto simulation = make_simulation(backend, two_worlds(), {}, 1);
      BodyState s = simulation->body(0, 1);
      s.velocity.y = bad;
      simulation->set_body(0, 1, s);
      simulation->advance(5);
      INFO(name_of(backend) << " velocity " << bad);
      CHECK((simulation->report(0).flags & flag_not_finite) != 0);
      CHECK(simulation->report(1).flags == 0);
      CHECK(simulation->body(1, 1).position.z == Approx(0.05).margin(1e-6));
    }
}

TEST_CASE("a place that is not a number is flagged in its world, and the batch goes on") {
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, two_worlds(), {}, 1);
    BodyState s = simulation->body(0, 1);
    s.position.x = std::numeric_limits<double>::quiet_NaN();
    simulation->set_body(0, 1, s);
    simulation->advance(5);
    CHECK((simulation->report(0).flags & flag_not_finite) != 0);
    CHECK(simulation->report(1).flags == 0);
  }
}

TEST_CASE("a body that crosses more than a bin in a step is flagged") {
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, two_worlds(), {}, 1);
    BodyState s = simulation->body(0, 1);
    // Bins are at least a diameter wide, 0.1 m, and at most twice that: 150 m/s stays under 0.2 m in a millisecond.
    s.velocity.z = 50;
    simulation->set_body(0, 1, s);
    simulation->advance(1);
    CHECK(simulation->report(0).flags == 0);
    s.velocity.z = 300;
    simulation->set_body(0, 1, s);
    simulation->advance(1);
    CHECK(simulation->report(0).flags == flag_too_fast);
    CHECK(simulation->report(1).flags == 0);
  }
}

TEST_CASE("as often as asked for a body that crosses more than a bin in a step is slowed to that instead") {
  for (const Backend backend : backends()) {
    StepSettings settings;
    settings.max_slowed = 2;
    const auto simulation = make_simulation(backend, two_worlds(), settings, 1);
    const auto throw_up = [&](double speed) {
      BodyState s = simulation->body(0, 1);
      s.position.z = 0.3;
      s.velocity = {0, 0, Real(speed)};
      simulation->set_body(0, 1, s);
      simulation->advance(1);
      return simulation->body(0, 1);
    };
    for (Index times = 1; times <= 2; ++times) {
      const BodyState after = throw_up(300);
      CHECK(simulation->report(0).slowed == times);
      CHECK(simulation->report(0).flags == 0);
      // Bins are one to two diameters of 0.1 m wide.
      CHECK(after.velocity.z > 99);
      CHECK(after.velocity.z < 200);
      CHECK(after.position.z - 0.3 == Approx(after.velocity.z * 1e-3).epsilon(1e-4));
    }
    const Snapshot before = simulation->snapshot(0);
    throw_up(300);
    CHECK(simulation->report(0).flags == flag_too_fast);
    CHECK(simulation->report(0).slowed == 2);
    CHECK(simulation->report(1).slowed == 0);
    simulation->restore(0, before);
    CHECK(simulation->report(0).slowed == 2);
    CHECK(simulation->report(0).flags == 0);
    throw_up(50);
    CHECK(simulation->report(0).flags == 0);
  }
}

TEST_CASE("a body of a mechanism and one without a number are never slowed") {
  for (const Backend backend : backends()) {
    StepSettings settings;
    settings.max_slowed = 1000;
    Scene scene = two_worlds();
    scene[0].joint.push_back(spherical(scene[0], 1, 2, {0.45, 0.5, 0.05}));
    const auto simulation = make_simulation(backend, scene, settings, 1);
    BodyState s = simulation->body(0, 1);
    s.velocity.z = 900;
    simulation->set_body(0, 1, s);
    s = simulation->body(1, 1);
    s.velocity.z = std::numeric_limits<Real>::quiet_NaN();
    simulation->set_body(1, 1, s);
    simulation->advance(1);
    CHECK((simulation->report(0).flags & flag_too_fast) != 0);
    CHECK((simulation->report(1).flags & flag_not_finite) != 0);
    CHECK(simulation->report(0).slowed + simulation->report(1).slowed == 0);
  }
}

TEST_CASE("a body that falls out of the domain is flagged, for good") {
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, two_worlds(), {}, 1);
    BodyState s = simulation->body(1, 2);
    s.position.z = -0.2;
    simulation->set_body(1, 2, s);
    simulation->advance(1);
    CHECK(simulation->report(1).flags == flag_left_domain);
    s.position.z = 0.5;
    simulation->set_body(1, 2, s);
    simulation->advance(1);
    CHECK(simulation->report(1).flags == flag_left_domain);
    CHECK(simulation->report(0).flags == 0);
  }
}

TEST_CASE("the first fault names its body and step, also after a restore") {
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, two_worlds(), {}, 1);
    simulation->advance(7);
    CHECK(simulation->report(1).fault.flags == 0);
    CHECK(description(simulation->report(1).fault, 1e-3).empty());
    BodyState s = simulation->body(1, 2);
    s.position.z = -0.2;
    simulation->set_body(1, 2, s);
    simulation->advance(3);
    s = simulation->body(1, 1);
    s.velocity.z = std::numeric_limits<Real>::quiet_NaN();
    simulation->set_body(1, 1, s);
    simulation->advance(2);
    const Fault fault = simulation->report(1).fault;
    INFO(name_of(backend));
    CHECK(fault.body == 2);
    CHECK(fault.step == 8);
    CHECK(fault.flags == flag_left_domain);
    CHECK(description(fault, 1e-3) == "body 2 in step 8 (at 0.008 s) has left the domain");
    CHECK(simulation->report(0).fault.flags == 0);
    const auto other = make_simulation(backend, two_worlds(), {}, 1);
    other->restore(1, simulation->snapshot(1));
    CHECK(other->report(1).fault.step == 8);
    CHECK(other->report(1).fault.body == 2);
    other->replace(1, two_worlds()[1]);
    CHECK(other->report(1).fault.flags == 0);
  }
}

TEST_CASE("a scene that cannot run is refused with a reason") {
  const StepSettings settings;
  CHECK_THROWS_AS(make_simulation(Backend::cpu, {}, settings, 1), InputError);
  CHECK_THROWS_AS(make_simulation(Backend::cpu, {SceneWorld{}}, settings, 1), InputError);
  Scene narrow = two_worlds();
  narrow[0].periodic_x = true;
  narrow[0].size.x = 0.25;
  CHECK_THROWS_AS(make_simulation(Backend::cpu, narrow, settings, 1), InputError);
  StepSettings none;
  none.iterations = 0;
  CHECK_THROWS_AS(make_simulation(Backend::cpu, two_worlds(), none, 1), InputError);
  Scene motor = two_worlds();
  motor[1].motor.push_back(speed_motor(motor[1], 0, kWorld, {0, 1, 0}, 1, 1));  // the plane is fixed
  CHECK_THROWS_AS(make_simulation(Backend::cpu, motor, settings, 1), InputError);
  Scene spring = two_worlds();
  spring[0].spring.push_back(spring_between(spring[0], 0, 0, {0, 0, 0}, {0, 0, 1}, 100, 1));
  CHECK_THROWS_AS(make_simulation(Backend::cpu, spring, settings, 1), InputError);
  Scene material = two_worlds();
  material[0].shape[1].material = kMaxMaterials;
  CHECK_THROWS_AS(make_simulation(Backend::cpu, material, settings, 1), InputError);
}

TEST_CASE("a wheel that can only turn grinds against a fixed grain with finite impulses") {
  SceneWorld w;
  w.size = {2, 2, 2};
  w.set_law(0, 0, {Real(0.5), 0, 0});
  Shape s;
  s.type = ShapeType::wheel;
  s.size = {0.3f, 0.1f, 0};
  BodyMass m;  // isotropic is left at its default: the engine finds out by itself
  m.inverse_inertia_B = {0, 10, 0};
  s.body = w.add_body({{1, 1, 1}, {}, {}, {}}, m);
  w.add_shape(s);
  // In the wheel's mid-plane the arm lies along the normal: neither body gives way along it.
  w.add_sphere({1, 1, 0.649}, 0.05f, 2000, 0);
  w.mass[1] = fixed_body();
  w.motor.push_back(speed_motor(w, 0, kWorld, {0, 1, 0}, 4, 20));
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, w, {});
    simulation->advance(200);
    CHECK(simulation->report(0).contact_count == 1);
    CHECK(simulation->report(0).flags == 0);
    // A gap is left, so the motor reaches its speed. Single precision at 4 rad/s.
    CHECK(simulation->body(0, 0).angular_velocity.y == Approx(4).epsilon(1e-5));
    BodyState grain = simulation->body(0, 1);
    grain.position.z += 0.003;
    simulation->set_body(0, 1, grain);
    simulation->advance(200);
    // Overlapping, it is jammed.
    CHECK(simulation->report(0).flags == 0);
    CHECK(std::abs(simulation->body(0, 0).angular_velocity.y) < 0.1f);
  }
}
