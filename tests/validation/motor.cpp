// Motors between bodies: work, limit and reaction.
#include <cmath>
#include <string>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

SceneWorld free_world() {
  SceneWorld w;
  w.gravity = {};
  w.origin = {-10, -10, -10};
  w.size = {20, 20, 20};
  return w;
}

BodyMass ball(double mass, double inertia) { return solid(Real(mass), {Real(inertia), Real(inertia), Real(inertia)}); }

double spin(const BodyState& s, const Vec3d& axis) { return dot(static_cast<Vec3d>(s.angular_velocity), axis); }

struct Momentum3 {
  Vec3d linear, angular;
  double size = 0;  // sum of magnitudes of the angular parts
};

Momentum3 momentum_of(const SceneWorld& w, const std::vector<BodyState>& body) {
  Momentum3 sum;
  for (std::size_t b = 0; b < body.size(); ++b) {
    const double mass = 1 / w.mass[b].inverse_mass.x, inertia = 1 / w.mass[b].inverse_inertia_B.x;
    const auto v = static_cast<Vec3d>(body[b].velocity), s = static_cast<Vec3d>(body[b].angular_velocity);
    const Vec3d angular = cross(body[b].position, v) * mass + s * inertia;
    sum.linear += v * mass;
    sum.angular += angular;
    sum.size += length(angular);
  }
  return sum;
}

/// A frame with four wheels around it in free space, each on a revolute joint with a motor against the frame.
SceneWorld satellite(double limit) {
  SceneWorld w = free_world();
  const BodyIndex frame = w.add_body({{}, {}, {}, {}}, ball(50, 4));
  for (int k = 0; k < 4; ++k) {
    const Vec3d at{k < 2 ? 1.0 : -1.0, k % 2 ? 0.6 : -0.6, 0.1 * k};
    const BodyIndex wheel = w.add_body({at, {}, {}, {}}, ball(5, 0.1 + 0.1 * k));
    w.joint.push_back(revolute(w, wheel, frame, at, {0.1 * k, 1, 0}));
    w.motor.push_back(speed_motor(w.joint.back(), 3 + k, limit));
  }
  return w;
}

}  // namespace

TEST_CASE("a motor's work is the gain of kinetic energy plus what the damper takes") {
  const double damping = 0.05, step = 5e-3;
  const Vec3d axis{0.6, 0, 0.8};
  for (const Backend backend : backends()) {
    SceneWorld w = free_world();
    const BodyIndex ground = w.add_body({}, fixed_body());
    const BodyIndex arm = w.add_body({{0, 1, 0}, {}, {}, {}}, ball(3, 0.5));
    const BodyIndex wheel = w.add_body({{0, 2, 0}, {}, {}, {}}, ball(1, 0.2));
    w.joint.push_back(revolute(w, arm, ground, {}, axis));
    w.joint.push_back(revolute(w, wheel, arm, {0, 2, 0}, axis));
    w.spring.push_back(spring_about(w.joint[1], 0, 0, damping));
    w.motor.push_back(speed_motor(w.joint[1], 20, 1.5));
    StepSettings settings = settings_with(50);
    settings.step = Real(step);
    const auto simulation = simulate(backend, w, settings);
    double work = 0, lost = 0, before = 0, largest = 0;
    for (int i = 0; i < 2000; ++i) {
      simulation->advance(1);
      const double now = spin(simulation->body(0, wheel), axis) - spin(simulation->body(0, arm), axis);
      const double torque = simulation->motor_torque(0, 0), mean = 0.5 * (now + before);
      largest = std::max(largest, std::fabs(torque));
      // Impulse times the mean of the speeds before and after is the exact work of one step, however long it is.
      work += torque * step * mean;
      lost -= dot(simulation->spring_load(0, 0).moment, axis) * step * mean;
      before = now;
    }
    CHECK(
        agrees("motor, work less damper's share [J]", simulation->report(0).kinetic_energy, work - lost, 2e-3 * work));
    CHECK(lost > 0.5 * work);
    CHECK(agrees("motor, largest torque [N m]", 1.5, largest, 1e-5));
    CHECK(agrees("motor, speed of the wheel on the arm [rad/s]", 20, before, 1e-3));
  }
}

TEST_CASE("motors on a free frame reach their speeds, react on it, and leave both momenta alone") {
  const double limit = 2;
  for (const Backend backend : backends()) {
    const SceneWorld w = satellite(limit);
    const auto simulation = simulate(backend, w, settings_with(40));
    double torque = 0, error = 0, size = 0;
    for (int i = 0; i < 300; ++i) {
      simulation->advance(10);
      for (int k = 0; k < 4; ++k) torque = std::max(torque, std::fabs(simulation->motor_torque(0, k)));
      const Momentum3 m = momentum_of(w, simulation->bodies(0));
      size = std::max(size, m.size);
      error = std::max({error, length(m.angular), length(m.linear)});
    }
    CHECK(agrees("satellite, largest torque over the limit [-]", 1, torque / limit, 1e-5));
    CHECK(agrees("satellite, momentum over the sum of its parts [-]", 0, error / size, 2e-4));
    const auto body = simulation->bodies(0);
    for (int k = 0; k < 4; ++k) {
      const Vec3d axis = pose_of(body[std::size_t(k) + 1]).direction(w.joint[k].a.axis_B);
      CHECK(agrees("satellite, speed of a wheel on the frame [rad/s]", 3 + k,
                   spin(body[std::size_t(k) + 1], axis) - spin(body[0], axis), 2e-3));
    }
    CHECK(agrees("satellite, drift [m]", 0, drift(w, body), 1e-4));
  }
}

TEST_CASE("a torque motor accelerates its body at T / I and pushes back on the other") {
  for (const Backend backend : backends()) {
    SceneWorld w = free_world();
    const BodyIndex a = w.add_body({}, ball(1, 0.5)), b = w.add_body({{0, 0, 0.2}, {}, {}, {}}, ball(2, 2));
    w.joint.push_back(revolute(w, a, b, {}, {0, 0, 1}));
    w.motor.push_back(torque_motor(w.joint[0], 3));
    const auto simulation = simulate(backend, w, settings_with(10));
    advance_for(*simulation, 1);
    CHECK(agrees("torque motor, speed of a [rad/s]", 6, simulation->body(0, a).angular_velocity.z, 1e-4));
    CHECK(agrees("torque motor, speed of b [rad/s]", -1.5, simulation->body(0, b).angular_velocity.z, 1e-4));
    simulation->set_motor(0, 0, -3, 0);
    advance_for(*simulation, 1);
    CHECK(agrees("torque motor, reversed, speed of a [rad/s]", 0, simulation->body(0, a).angular_velocity.z, 2e-4));
  }
}

TEST_CASE("the steps of motors that react on one frame are safe and not timid: speeds settle in a few iterations") {
  for (const Backend backend : backends())
    for (const Index iterations : {10, 40}) {
      const auto simulation = simulate(backend, satellite(1e6), settings_with(iterations));
      simulation->advance(1);
      const auto body = simulation->bodies(0);
      double worst = 0;
      for (int k = 0; k < 4; ++k) {
        const Vec3d axis = pose_of(body[std::size_t(k) + 1]).direction(satellite(1).joint[k].a.axis_B);
        worst = std::max(worst, std::fabs(spin(body[std::size_t(k) + 1], axis) - spin(body[0], axis) - (3 + k)));
      }
      // From rest to 6 rad/s in one step without a warm start.
      CHECK(agrees("motors from rest, " + std::to_string(iterations) + " iterations, speed error [rad/s]", 0, worst,
                   iterations == 10 ? 0.3 : 1e-2));
    }
}
