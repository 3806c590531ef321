// A step of several substeps against as many small steps.
#include <algorithm>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

double norm(const Vec3d& v) { return std::sqrt(dot(v, v)); }
double norm(const Vec3& v) { return norm(static_cast<Vec3d>(v)); }

constexpr Real kSmall = 1.0f / 4096;  // [s], so that substeps have the same bits
constexpr Index kSubsteps = 5;

StepSettings small_steps() {
  StepSettings s;
  s.step = kSmall;
  s.iterations = 60;
  return s;
}

StepSettings in_substeps() {
  StepSettings s = small_steps();
  s.step = kSubsteps * kSmall;
  s.substeps = kSubsteps;
  return s;
}

/// A ball with spin on a floor that slows it, and a second one on its way through the air.
SceneWorld two_balls(const PairLaw& law) {
  SceneWorld w;
  w.origin = {-5, -5, -1};
  w.size = {10, 10, 6};
  w.set_law(0, 0, law);
  add_plane(w);
  const BodyIndex rolling = w.add_sphere({0, 0, 0.1}, 0.1f, 2000, 0);
  w.body[rolling].velocity = {1, 0, 0};
  const BodyIndex flying = w.add_sphere({1, 1, 3}, 0.1f, 2000, 0);
  w.body[flying].velocity = {0.5f, 0.25f, 2};
  w.body[flying].angular_velocity = {3, 2, 1};
  return w;
}

void check_same(const BodyState& a, const BodyState& b, double length, double speed) {
  CHECK(norm(a.position - b.position) < length);
  CHECK(norm(a.velocity - b.velocity) < speed);
  CHECK(norm(a.angular_velocity - b.angular_velocity) * 0.1 < speed);
}

constexpr double kRadius = 0.016;
constexpr Index kColumn = 20;

/// Two updates in each of 14 substeps of a millisecond, with give in the contacts.
StepSettings few_updates(Real give) {
  StepSettings s;
  s.step = 1e-3f;
  s.substeps = 14;
  s.iterations = 2;
  s.target = Target::coulomb;
  s.recovery_speed = 0.056f;
  s.envelope = 8e-4f;
  s.give = give;
  return s;
}

/// Grains one above the other that just touch, on vertical rails.
SceneWorld column() {
  SceneWorld w;
  w.origin = {-0.1, -0.1, -0.1};
  w.size = {0.2, 0.2, 0.2 + 2 * kRadius * (kColumn + 4)};
  add_plane(w);
  for (Index k = 0; k < kColumn; ++k) {
    const BodyIndex b = w.add_sphere({0, 0, (2 * k + 1) * kRadius}, Real(kRadius), 2650, 0);
    w.mass[std::size_t(b)].inverse_mass.x = w.mass[std::size_t(b)].inverse_mass.y = 0;
    w.mass[std::size_t(b)].inverse_inertia_B = {};
  }
  return w;
}

}  // namespace

TEST_CASE("a column of grains whose contacts give stays at rest with two updates in a substep") {
  // Without give grains shake at up to 0.2 m/s: overlaps push with a delay.
  for (const Backend backend : backends()) {
    const auto s = few_updates(0.6f);
    const auto simulation = simulate(backend, column(), s);
    simulation->advance(900);
    double fastest = 0;
    for (int k = 0; k < 100; ++k) {
      simulation->advance(1);
      for (const BodyState& b : simulation->bodies(0)) fastest = std::max(fastest, norm(b.velocity));
    }
    CAPTURE(name_of(backend));
    CHECK(fastest < 1e-4);
    // The lowest grain sinks by the column's weight over the stiffness give_share / (give substep^2 / mass).
    const double expected = s.give * kColumn * 9.81 * s.substep() * s.substep() / s.give_share;
    const auto bodies = simulation->bodies(0);
    const auto lowest = std::min_element(bodies.begin(), bodies.end(), [](const BodyState& a, const BodyState& b) {
      return (a.position.z > 1e-3 ? a.position.z : 1e9) < (b.position.z > 1e-3 ? b.position.z : 1e9);
    });
    CHECK(kRadius - lowest->position.z == Approx(expected).epsilon(0.05));
  }
}

TEST_CASE("a grain deep in the floor comes out no faster than the recovery speed, with give or without") {
  for (const Backend backend : backends())
    for (const Real give : {0.f, 0.6f}) {
      SceneWorld w;
      w.origin = {-0.2, -0.2, -0.2};
      w.size = {0.4, 0.4, 0.6};
      add_plane(w);
      const BodyIndex grain = w.add_sphere({0, 0, kRadius - 0.002}, Real(kRadius), 2650, 0);
      const auto s = few_updates(give);
      const auto simulation = simulate(backend, w, s);
      double fastest = 0;
      for (int k = 0; k < 200; ++k) {
        simulation->advance(1);
        fastest = std::max(fastest, norm(simulation->body(0, grain).velocity));
      }
      CAPTURE(name_of(backend), give);
      CHECK(fastest < 1.2 * s.recovery_speed);
      CHECK(fastest > 0.5 * s.recovery_speed);
      CHECK(simulation->body(0, grain).position.z > kRadius - 1e-5);
    }
}

TEST_CASE("a body in the air moves in substeps as in small steps") {
  for (const Backend backend : backends()) {
    const auto substeps = simulate(backend, two_balls({0.5f}), in_substeps());
    const auto small = simulate(backend, two_balls({0.5f}), small_steps());
    substeps->advance(20);
    small->advance(20 * kSubsteps);
    const BodyState a = substeps->body(0, 2), b = small->body(0, 2);
    CHECK(norm(a.position - b.position) < 1e-7);
    CHECK(norm(a.velocity - b.velocity) == 0);
    CHECK(substeps->report(0).time == small->report(0).time);
  }
}

TEST_CASE("sliding, rolling and compliant contacts in substeps follow small steps") {
  PairLaw rolling{0.3f, 0.05f}, soft{0.3f};
  soft.stiffness = 2e5f;
  soft.damping = 100;
  for (const Backend backend : backends())
    for (const PairLaw& law : {PairLaw{0.3f}, rolling, soft}) {
      const auto substeps = simulate(backend, two_balls(law), in_substeps());
      const auto small = simulate(backend, two_balls(law), small_steps());
      substeps->advance(100);
      small->advance(100 * kSubsteps);
      check_same(substeps->body(0, 1), small->body(0, 1), 1e-4, 1e-3);
      CHECK(substeps->contact_force(0, 1).z == Approx(small->contact_force(0, 1).z).epsilon(0.02));
    }
}

TEST_CASE("motors give the same torque in substeps as in small steps") {
  SceneWorld w;
  w.origin = {-1, -1, -1};
  w.size = {2, 2, 2};
  const BodyIndex disc = w.add_body({{0, 0, 0}, {}, {}, {}}, solid(2, {0.02f, 0.02f, 0.04f}));
  const BodyIndex stand = w.add_body({}, fixed_body());
  w.joint.push_back(revolute(w, disc, stand, {0, 0, 0}, {0, 0, 1}));
  w.motor.push_back(speed_motor(w.joint.back(), 10, 0.5));
  for (const Backend backend : backends()) {
    const auto substeps = simulate(backend, w, in_substeps());
    const auto small = simulate(backend, w, small_steps());
    substeps->advance(40);
    small->advance(40 * kSubsteps);
    CHECK(substeps->motor_torque(0, 0) == Approx(0.5).epsilon(1e-4));
    CHECK(substeps->body(0, disc).angular_velocity.z == Approx(0.5 / 0.04 * 40 * kSubsteps * kSmall).epsilon(1e-4));
    CHECK(substeps->body(0, disc).angular_velocity.z == Approx(small->body(0, disc).angular_velocity.z).epsilon(1e-5));
  }
}

TEST_CASE("contacts that close within a step are closed by its parts") {
  SceneWorld w;
  w.origin = {-5, -5, -1};
  w.size = {10, 10, 6};
  add_plane(w);
  const BodyIndex ball = w.add_sphere({0, 0, 0.101}, 0.1f, 2000, 0);
  w.body[ball].velocity = {0, 0, -1.5f};
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, w, in_substeps());
    simulation->advance(3);
    CHECK(simulation->body(0, ball).position.z == Approx(0.1).margin(2e-5));
    CHECK(std::abs(simulation->body(0, ball).velocity.z) < 1e-3);
  }
}

/// A body that only turns about a motor's axis, and a box that slides on four corners.
SceneWorld driven_and_sliding() {
  SceneWorld w;
  w.origin = {-5, -5, -1};
  w.size = {10, 10, 6};
  w.set_law(0, 0, {0.3f, 0, 0});
  add_plane(w);
  const BodyIndex box = add_box(w, {{0, 0, 0.1}, {}, {}, {}}, {0.1f, 0.1f, 0.1f}, 5);
  w.body[box].velocity = {1, 0.5f, 0};
  const BodyIndex disc = w.add_body({{0, 0, 2}, {}, {}, {}}, solid(2, {0.02f, 0.02f, 0.04f}));
  w.joint.push_back(revolute(w, disc, 0, {0, 0, 2}, {0, 0, 1}));
  w.motor.push_back(speed_motor(w.joint.back(), 10, 0.5));
  return w;
}

TEST_CASE("a substep with few sweeps does what a small step with as few does") {
  for (const Backend backend : backends())
    for (const Index iterations : {1, 2, 3}) {
      StepSettings with_substeps = in_substeps(), with_steps = small_steps();
      with_substeps.iterations = with_steps.iterations = iterations;
      with_substeps.iteration = with_steps.iteration = Iteration::gauss_seidel;
      const auto substeps = simulate(backend, driven_and_sliding(), with_substeps);
      const auto small = simulate(backend, driven_and_sliding(), with_steps);
      substeps->advance(20);
      small->advance(20 * kSubsteps);
      INFO(iterations << " iterations");
      CHECK(substeps->report(0).iterations == kSubsteps * iterations);
      for (const BodyIndex b : {1, 2}) check_same(substeps->body(0, b), small->body(0, b), 2e-5, 2e-4);
    }
}

TEST_CASE("momentum that goes on from substep to substep leads to the same motion") {
  for (const Backend backend : backends()) {
    StepSettings with_substeps = in_substeps(), with_steps = small_steps();
    with_substeps.iterations = with_steps.iterations = 10;
    const auto substeps = simulate(backend, driven_and_sliding(), with_substeps);
    const auto small = simulate(backend, driven_and_sliding(), with_steps);
    substeps->advance(100);
    small->advance(100 * kSubsteps);
    for (const BodyIndex b : {1, 2}) check_same(substeps->body(0, b), small->body(0, b), 2e-4, 1e-3);
  }
}
