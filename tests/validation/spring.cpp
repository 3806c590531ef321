// The implicit spring and damper against the oscillator's closed form, and a motor's speed and torque limit.
#include <cmath>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// A mass on a spring above a fixed body.
SceneWorld sprung_mass(double mass, double stiffness, double damping) {
  SceneWorld w;
  w.origin = {-5, -5, -5};
  w.size = {10, 10, 10};
  const BodyIndex ground = w.add_body({}, fixed_body());
  const BodyIndex upper = w.add_body({{0, 0, 1}, {}, {}, {}}, solid(Real(mass), {1, 1, 1}));
  w.spring.push_back(spring_along(w, upper, ground, {0, 0, 1}, {}, {0, 0, 1}, stiffness, damping));
  return w;
}

StepSettings with_step(double step) {
  StepSettings s;
  s.step = Real(step);
  return s;
}

}  // namespace

TEST_CASE("a sprung mass settles at m g / k") {
  for (const Backend backend : backends())
    for (const double mass : {5.0, 500.0}) {
      const double stiffness = 20000, damping = 2 * std::sqrt(stiffness * mass);
      const auto simulation = simulate(backend, sprung_mass(mass, stiffness, damping), with_step(1e-3));
      advance_for(*simulation, 4);
      const double expected = 1 - mass * kGravity / stiffness, z = simulation->body(0, 1).position.z;
      // At rest the scheme has no error of its own; single-precision speeds below 1e-7 m/s no longer move the mass.
      CHECK(agrees(std::string("spring, height under load [m], ") + name_of(backend), expected, z,
                   1e-5 * mass * kGravity / stiffness + 1e-6));
    }
}

TEST_CASE("a sprung mass swings with the damped oscillator's period and decay") {
  const double mass = 50, stiffness = 20000, damping = 200, step = 1e-4;
  const double omega = std::sqrt(stiffness / mass), ratio = damping / (2 * std::sqrt(stiffness * mass));
  const double damped = omega * std::sqrt(1 - ratio * ratio);
  for (const Backend backend : backends()) {
    SceneWorld w = sprung_mass(mass, stiffness, damping);
    w.gravity = {};
    w.body[1].position.z = 1.05;
    const auto simulation = simulate(backend, w, with_step(step));
    // Downward crossings of the rest height, and the peaks in between.
    std::vector<double> crossing, peak{0.05};
    double last = 0.05, top = 0;
    const int stride = 10;  // 1 ms of a period of 316 ms
    for (int i = 1; i < 2000 && crossing.size() < 6; ++i) {
      simulation->advance(stride);
      const double z = simulation->body(0, 1).position.z - 1;
      if (last > 0 && z <= 0) {
        crossing.push_back((i - 1 + last / (last - z)) * stride * step);
        if (crossing.size() > 1) peak.push_back(top);
        top = 0;
      }
      top = std::max(top, z);
      last = z;
    }
    REQUIRE(crossing.size() == 6);
    const double period = (crossing.back() - crossing.front()) / 5;
    const double decay = std::log(peak[1] / peak[5]) / (4 * period);
    // Implicit in its speed: the period is exact to (omega h)^2, the decay gains omega^2 h / 2 = 0.02 1/s of 2.
    CHECK(agrees("spring, period [s]", 2 * kPi / damped, period, 1e-3 * period));
    CHECK(agrees("spring, decay [1/s]", ratio * omega, decay, omega * omega * step / 2 * 1.2));
  }
}

TEST_CASE("two sprung bodies swing about their common centre, which falls freely") {
  const double upper_mass = 40, lower_mass = 10, stiffness = 1e4, step = 1e-4;
  for (const Backend backend : backends()) {
    SceneWorld w;
    w.origin = {-5, -5, -50};
    w.size = {10, 10, 100};
    const BodyIndex lower = w.add_body({{0, 0, 0}, {}, {}, {}}, solid(Real(lower_mass), {1, 1, 1}));
    const BodyIndex upper = w.add_body({{0, 0, 1.02}, {}, {}, {}}, solid(Real(upper_mass), {1, 1, 1}));
    w.spring.push_back(spring_along(w, upper, lower, {0, 0, 1.02}, {}, {0, 0, 1}, stiffness, 0));
    w.spring[0].free_length = 1;
    const auto simulation = simulate(backend, w, with_step(step));
    const double reduced = upper_mass * lower_mass / (upper_mass + lower_mass);
    const double omega = std::sqrt(stiffness / reduced), half_period = kPi / omega;
    advance_for(*simulation, half_period);
    const double t = simulation->report(0).time;
    const BodyState a = simulation->body(0, upper), b = simulation->body(0, lower);
    const double centre = (upper_mass * a.position.z + lower_mass * b.position.z) / (upper_mass + lower_mass);
    const double expected = upper_mass * 1.02 / (upper_mass + lower_mass) - 0.5 * kGravity * t * (t + step);
    CHECK(agrees("two sprung bodies, centre of mass [m]", expected, centre, 1e-6));
    // After half a period the stretch has changed sign; the implicit step damps by omega^2 h / 2.
    CHECK(agrees("two sprung bodies, stretch after half a period [m]", -0.02 * std::exp(-omega * omega * step / 2 * t),
                 a.position.z - b.position.z - 1, 2e-4));
  }
}

TEST_CASE("a stiff spring with a long step stays bounded") {
  for (const Backend backend : backends()) {
    SceneWorld w = sprung_mass(1, 1e8, 0);  // omega h = 100
    w.body[1].position.z = 1.01;
    const auto simulation = simulate(backend, w, with_step(1e-2));
    simulation->advance(200);
    CHECK(std::abs(simulation->body(0, 1).position.z - 1) < 0.01);
    CHECK(std::abs(simulation->body(0, 1).velocity.z) < 1e-2f);
  }
}
