// Forces on bodies against their closed forms. g is off unless a test says otherwise.
#include <cmath>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

SceneWorld empty_space() {
  SceneWorld w;
  w.gravity = {0, 0, 0};
  w.origin = {-500, -500, -500};
  w.size = {1000, 1000, 1000};
  return w;
}

StepSettings steps_of(double h) {
  StepSettings s;
  s.step = Real(h);
  return s;
}

ForceElement load(BodyIndex body, const Vec3& force, const Vec3& torque = {}, const Vec3& point_B = {}) {
  ForceElement f;
  f.body = body;
  f.force = force;
  f.torque = torque;
  f.point_B = point_B;
  return f;
}

}  // namespace

TEST_CASE("a constant force and torque accelerate a body at F / m and T / I; an arm adds its torque") {
  for (const Backend backend : backends()) {
    SceneWorld w = empty_space();
    const BodyIndex b = w.add_body({}, solid(4, {2, 2, 2}));
    const BodyIndex rails = w.add_body({{5, 0, 0}, {}, {}, {}}, [] {
      BodyMass m;
      m.inverse_mass = {0.5f, 0, 0};
      return m;
    }());
    w.force = {load(rails, {3, 7, 0}), load(b, {8, 0, 0}, {0, 0, 1}), load(b, {0, 0, -2}, {}, {0.5f, 0, 0})};
    const auto simulation = simulate(backend, w, steps_of(1e-3));
    simulation->advance(500);
    const BodyState s = simulation->body(0, b), r = simulation->body(0, rails);
    INFO(name_of(backend));
    CHECK(s.velocity.x == Approx(8.0 / 4 * 0.5).epsilon(1e-5));
    CHECK(s.velocity.z == Approx(-2.0 / 4 * 0.5).epsilon(1e-5));
    CHECK(s.position.x == Approx(8.0 / 4 * 0.5 * 1e-6 * 500 * 501).epsilon(1e-5));
    CHECK(s.angular_velocity.z == Approx(1.0 / 2 * 0.5).epsilon(1e-5));
    // (0.5, 0, 0) x (0, 0, -2) = (0, 1, 0), while the arm has turned by little.
    CHECK(s.angular_velocity.y == Approx(1.0 / 2 * 0.5).epsilon(0.01));
    CHECK(r.velocity.x == Approx(3.0 * 0.5 * 0.5).epsilon(1e-5));
    CHECK(r.velocity.y == 0);  // it cannot move there
    CHECK(simulation->report(0).force_power ==
          Approx(8 * s.velocity.x - 2 * s.velocity.z + s.angular_velocity.z + s.angular_velocity.y + 3 * r.velocity.x)
              .epsilon(0.01));
  }
}

TEST_CASE("a force in the body's frame turns with the body; in the world's frame it does not") {
  const double spin = 3, time = 0.7, share = 2.0 / 5;
  for (const Backend backend : backends()) {
    SceneWorld w = empty_space();
    for (const ReferenceFrame frame : {ReferenceFrame::body, ReferenceFrame::world}) {
      const BodyIndex b = w.add_body({{2.0 * int(frame), 0, 0}, {}, {}, {0, 0, Real(spin)}}, solid(5, {1, 1, 1}));
      w.force.push_back(load(b, {2, 0, 0}));
      w.force.back().frame = frame;
    }
    const auto simulation = simulate(backend, w, steps_of(2e-4));
    advance_for(*simulation, time);
    const Vec3 fixed = simulation->body(0, 1).velocity, turning = simulation->body(0, 0).velocity;
    INFO(name_of(backend));
    CHECK(fixed.x == Approx(share * time).epsilon(1e-5));
    CHECK(fixed.y == 0);
    CHECK(std::abs(turning.x - share / spin * std::sin(spin * time)) < 1e-4);  // h F / m and less
    CHECK(std::abs(turning.y - share / spin * (1 - std::cos(spin * time))) < 1e-4);
  }
}

TEST_CASE("a ramped tow load pulls against its direction with the integral of the ramp") {
  const double pull = 30, mass = 6, start = 0.1, ramp = 0.4;
  for (const Backend backend : backends()) {
    SceneWorld w = empty_space();
    const BodyIndex b = w.add_body({}, solid(Real(mass), {1, 1, 1}));
    w.force.push_back(tow_load(b, ReferenceFrame::world, {0, 0.5f, 0}, pull));
    w.force.back().start = start;
    w.force.back().ramp = ramp;
    const auto simulation = simulate(backend, w, steps_of(1e-3));
    INFO(name_of(backend));
    simulation->advance(100);
    CHECK(simulation->body(0, b).velocity.y == 0);
    simulation->advance(200);
    CHECK(simulation->body(0, b).velocity.y == Approx(-pull / mass * 0.2 * 0.2 / (2 * ramp)).epsilon(0.006));  // h / 2t
    simulation->advance(400);
    CHECK(simulation->body(0, b).velocity.y == Approx(-pull / mass * (ramp / 2 + 0.2)).epsilon(0.002));
  }
}

TEST_CASE("drag slows a body to v0 / (1 + k v0 t), exactly, for any step, and never turns it back") {
  const double v0 = 40, mass = 2;
  const ForceElement drag = aerodynamic_drag(0, 1.2, 0.9, 0.8);
  const double k = 0.5 * 1.2 * 0.9 * 0.8 / mass;
  for (const Backend backend : backends())
    for (const double h : {1e-3, 0.05, 1.0}) {
      SceneWorld w = empty_space();
      w.add_body({{-400, 0, 0}, {}, {0, Real(0.6 * v0), Real(0.8 * v0)}, {}}, solid(Real(mass), {1, 1, 1}));
      w.force.push_back(drag);
      const auto simulation = simulate(backend, w, steps_of(h));
      advance_for(*simulation, 2);
      const Vec3 v = simulation->body(0, 0).velocity;
      INFO(name_of(backend) << ", step " << h);
      CHECK(v.y == Approx(0.6 * v0 / (1 + k * v0 * 2)).epsilon(1e-4));
      CHECK(v.z == Approx(0.8 * v0 / (1 + k * v0 * 2)).epsilon(1e-4));
    }
}

TEST_CASE("a falling body reaches its terminal velocity along sqrt(g / k) tanh(sqrt(g k) t)") {
  const double k = 0.02, h = 1e-3, mass = 3;
  for (const Backend backend : backends()) {
    SceneWorld w = empty_space();
    w.gravity = {0, 0, Real(-kGravity)};
    w.add_body({{0, 0, 400}, {}, {}, {}}, solid(Real(mass), {1, 1, 1}));
    w.force.push_back(aerodynamic_drag(0, 2 * k * mass, 1, 1));
    const auto simulation = simulate(backend, w, steps_of(h));
    const double terminal = std::sqrt(kGravity / k), rate = std::sqrt(kGravity * k);
    INFO(name_of(backend));
    advance_for(*simulation, 1);
    CHECK(std::abs(-simulation->body(0, 0).velocity.z - terminal * std::tanh(rate)) < kGravity * h);
    advance_for(*simulation, 19);
    // Where the discrete law rests: v^2 = g h v + g / k. In single precision it rests once a step would change the
    // speed by less than its last bit, 2e-6 m/s: within 2e-6 / (2 h sqrt(g k)) = 2e-3 m/s.
    const double rest = 0.5 * (kGravity * h + std::sqrt(kGravity * h * kGravity * h + 4 * kGravity / k));
    CHECK(-simulation->body(0, 0).velocity.z == Approx(rest).margin(2e-3));
    CHECK(std::abs(rest - terminal) < kGravity * h);
  }
}

TEST_CASE("wind carries a body along; drag on an arm stops a spin without turning it back at a long step") {
  for (const Backend backend : backends()) {
    SceneWorld w = empty_space();
    ForceElement wind = aerodynamic_drag(w.add_body({}, solid(1, {1, 1, 1})), 1, 1, 4);
    wind.wind = {0, 6, 0};
    const BodyIndex paddle = w.add_body({{50, 0, 0}, {}, {}, {0, 0, 30}}, [] {
      BodyMass m;
      m.inverse_inertia_B = {0, 0, 2};
      return m;
    }());
    w.force = {wind, aerodynamic_drag(paddle, 1, 1, 10, {1, 0, 0})};
    const auto simulation = simulate(backend, w, steps_of(0.02));
    INFO(name_of(backend));
    Real spin = 30;
    for (int i = 0; i < 100; ++i) {
      simulation->advance(1);
      const Real next = simulation->body(0, paddle).angular_velocity.z;
      REQUIRE(next > 0);
      REQUIRE(next < spin);
      spin = next;
    }
    // I w' = -1/2 c w^2 r^3: the same closed form as along a line.
    CHECK(spin == Approx(30 / (1 + 0.5 * 10 * 2 * 30 * 2.0)).epsilon(0.01));
    // The speed that is left against the wind decays as 6 / (1 + k 6 t), k = 2.
    CHECK(simulation->body(0, 0).velocity.y == Approx(6 - 6 / (1 + 2 * 6 * 2.0)).epsilon(1e-3));
  }
}

TEST_CASE("a force on a fixed or missing body, of a bad size or without direction is refused by name") {
  SceneWorld w = empty_space();
  const BodyIndex b = w.add_body({}, solid(1, {1, 1, 1})), floor = w.add_body({}, fixed_body());
  const auto with = [&](const ForceElement& f) {
    SceneWorld bad = w;
    bad.force = {load(b, {}), f};
    return [bad] { simulate(Backend::cpu, bad, {}); };
  };
  refused(with(load(7, {1, 0, 0})), "world 0: force 1 acts on body 7");
  refused(with(load(floor, {1, 0, 0})), "fixed body");
  refused(with(load(b, {1, NAN, 0})), "not finite");
  refused(with(aerodynamic_drag(b, 1, -1, 1)), "drag of -1");
  ForceElement ramped = load(b, {1, 0, 0});
  ramped.ramp = -1;
  refused(with(ramped), "ramp time");
  refused([&] { (void)tow_load(b, ReferenceFrame::world, {}, 1); }, "direction");
}
