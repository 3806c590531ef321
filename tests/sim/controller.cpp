// Controllers of motors against closed forms and ordinary differential equations.
#include <cmath>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kInertia = 0.5;  // of the turning body [kg m^2]

SceneWorld empty_space() {
  SceneWorld w;
  w.gravity = {0, 0, 0};
  w.origin = {-50, -50, -50};
  w.size = {100, 100, 100};
  return w;
}

/// A body that a motor turns about y, in empty space.
SceneWorld flywheel(const Controller& c) {
  SceneWorld w = empty_space();
  w.add_body({}, solid(1, {Real(kInertia), Real(kInertia), Real(kInertia)}));
  w.motor.push_back(speed_motor(w, 0, kWorld, {0, 1, 0}, 0, 0));
  w.controller.push_back(c);
  return w;
}

double speed_after(Simulation& simulation, double seconds) {
  advance_for(simulation, seconds);
  return simulation.body(0, 0).angular_velocity.y;
}

// A sphere that a motor rolls over rough ground without slip: (m + I / r^2) v' = T / r.
constexpr double kRadius = 0.25, kMass = 8;
constexpr double kRolling = kMass * 1.4;

SceneWorld rolling_sphere(const Controller& c) {
  SceneWorld w = empty_space();
  w.gravity = {0, 0, Real(-kGravity)};
  w.set_law(0, 0, {10, 0, 0});
  add_plane(w);
  const BodyIndex sphere = w.add_sphere({0, 0, kRadius}, Real(kRadius), density_for(kMass, kRadius), 0);
  w.motor.push_back(speed_motor(w, sphere, kWorld, {0, 1, 0}, 0, 0));
  w.controller.push_back(c);
  w.controller.back().body = sphere;
  return w;
}

Controller velocity_controller(ControllerType type, double velocity, double limit) {
  Controller c;
  c.type = type;
  c.frame = ReferenceFrame::world;
  c.command = {{0, velocity}};
  c.limit = {{0, limit}};
  return c;
}

/// Velocity under T = clamp(p e + i q), q' = e unless T is at its limit and e pushes on; Euler at a fiftieth of a step.
double rolling_velocity(const Controller& c, double time) {
  const double h = 2e-5, target = c.command[0].value, limit = c.limit[0].value;
  double v = 0, q = 0;
  for (int n = int(std::lround(time / h)); n > 0; --n) {
    const double e = target - v, wish = c.proportional * e + c.integral * q;
    if (!(std::abs(wish) > limit && wish * e > 0)) q += h * e;
    v += h * std::max(-limit, std::min(limit, wish)) / (kRadius * kRolling);
  }
  return v;
}

}  // namespace

TEST_CASE("a scheduled motor holds, ramps and holds its speed, and no more than its torque limit") {
  Controller c;
  c.command = {{0.2, 0}, {0.6, 8}, {0.8, -2}};
  c.limit = {{0, 1000}, {0.95, 1000}, {0.99, 3}};
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, flywheel(c), {});
    INFO(name_of(backend));
    CHECK(speed_after(*simulation, 0.2) == Approx(0).margin(1e-6));
    CHECK(speed_after(*simulation, 0.2) == Approx(4 - 0.02).epsilon(1e-4));  // the command of the step's beginning
    CHECK(speed_after(*simulation, 0.3) == Approx(3 + 0.05).epsilon(1e-4));
    CHECK(speed_after(*simulation, 0.3) == Approx(-2).epsilon(1e-4));
    simulation->set_body(0, 0, {{}, {}, {}, {0, 10, 0}});
    CHECK(speed_after(*simulation, 0.5) == Approx(10 - 3 / kInertia * 0.5).epsilon(0.01));
    CHECK(simulation->motor_torque(0, 0) == Approx(-3).epsilon(1e-5));
  }
}

TEST_CASE("throttle scales a falling torque curve: w = w0 (1 - exp(-s T0 t / (I w0))), both ways") {
  const double top = 40, stall = 5;
  for (const Backend backend : backends())
    for (const double throttle : {1.0, 0.5, -1.0}) {
      Controller c;
      c.type = ControllerType::throttle;
      c.command = {{0, throttle}};
      c.limit = {{0, stall}, {10, 0.75 * stall}, {top, 0}};
      const auto simulation = simulate(backend, flywheel(c), {});
      INFO(name_of(backend) << ", throttle " << throttle);
      const double size = std::abs(throttle), rate = size * stall / (kInertia * top);
      const double expected = top * (1 - std::exp(-rate * 3)) * (throttle < 0 ? -1 : 1);
      CHECK(speed_after(*simulation, 3) == Approx(expected).epsilon(1e-3));
    }
}

TEST_CASE("a motor that holds a speed drives within its falling curve and brakes with its torque at rest, both ways") {
  // Up: w = w0 (1 - exp(-T0 t / (I w0))) until the speed is there. Down: w = w1 - T0 t / I.
  const double top = 40, stall = 5, held = 30, low = 10;
  Controller c;
  c.type = ControllerType::held_speed;
  c.limit = {{0, stall}, {top, 0}};
  const double rate = stall / (kInertia * top), until = -std::log(1 - held / top) / rate;
  for (const Backend backend : backends())
    for (const double sign : {1.0, -1.0}) {
      INFO(name_of(backend) << ", sign " << sign);
      c.command = {{0, sign * held}};
      const auto up = simulate(backend, flywheel(c), {});
      CHECK(speed_after(*up, 0.5 * until) == Approx(sign * top * (1 - std::exp(-rate * 0.5 * until))).epsilon(2e-3));
      CHECK(speed_after(*up, until) == Approx(sign * held).epsilon(1e-3));
      c.command = {{0, sign * low}};
      const auto down = simulate(backend, flywheel(c), {});
      down->set_body(0, 0, {{}, {}, {}, {0, Real(sign * held), 0}});
      const double slowing = 0.5 * (held - low) * kInertia / stall;
      CHECK(speed_after(*down, slowing) == Approx(sign * (held - stall / kInertia * slowing)).epsilon(2e-3));
      CHECK(speed_after(*down, 2 * slowing) == Approx(sign * low).epsilon(1e-3));
    }
  c.limit = {{0, stall}};  // at every speed
  c.command = {{0, held}};
  const auto flat = simulate(Backend::cpu, flywheel(c), {});
  CHECK(speed_after(*flat, 1) == Approx(stall / kInertia).epsilon(1e-3));
}

TEST_CASE("a throttle that opens slowly gives the ramped share of a flat curve") {
  Controller c;
  c.type = ControllerType::throttle;
  c.command = {{0, 0}, {1, 1}};
  c.limit = {{0, 4}, {1000, 4}};
  for (const Backend backend : backends()) {
    const auto simulation = simulate(backend, flywheel(c), {});
    INFO(name_of(backend));
    CHECK(speed_after(*simulation, 1) == Approx(4 / kInertia / 2).epsilon(2e-3));
    CHECK(speed_after(*simulation, 0.5) == Approx(4 / kInertia).epsilon(2e-3));
  }
}

TEST_CASE("velocity by torque follows the differential equation of its law, free and at its torque limit") {
  for (const Backend backend : backends())
    for (const double limit : {1e6, 6.0}) {
      Controller c = velocity_controller(ControllerType::velocity_by_torque, 2, limit);
      c.proportional = 12;
      c.integral = 30;
      const auto simulation = simulate(backend, rolling_sphere(c), {});
      double highest = 0;
      for (int k = 1; k <= 40; ++k) {
        advance_for(*simulation, 0.05);
        const double v = simulation->body(0, 1).velocity.x;
        highest = std::max(highest, v);
        INFO(name_of(backend) << ", limit " << limit << ", time " << 0.05 * k);
        CHECK(std::abs(v - rolling_velocity(c, 0.05 * k)) < 0.012);  // h p 2 m/s / (r m) and less
      }
      CHECK(simulation->body(0, 1).velocity.x == Approx(2).epsilon(0.1));
      CHECK(highest < 2.6);
    }
}

TEST_CASE("velocity by motor speed follows its recursion; alone, feed-forward 1 / r is exact") {
  for (const Backend backend : backends())
    for (const double gain : {0.0, 1.6}) {
      Controller c = velocity_controller(ControllerType::velocity_by_speed, 1.5, 1e5);
      c.command = {{0, 0}, {0.2, 1.5}};  // 7.5 m/s^2, which the ground's friction can give
      c.top_speed = 100;
      c.feed_forward = gain == 0 ? 1 / kRadius : 0;
      c.proportional = gain;
      c.integral = 10 * gain;
      const auto simulation = simulate(backend, rolling_sphere(c), {});
      double v = 0, q = 0;
      INFO(name_of(backend) << ", gain " << gain);
      for (int k = 0; k < 300; ++k) {
        const double command = std::min(1.5, 7.5e-3 * k);
        q += 1e-3 * (command - v);
        v = kRadius * (c.feed_forward * command + gain * (command - v) + 10 * gain * q);
        simulation->advance(1);
        REQUIRE(simulation->body(0, 1).velocity.x == Approx(v).margin(3e-3));
      }
      if (gain == 0) CHECK(v == Approx(1.5));
    }
}

TEST_CASE("an axis in the body's frame measures the velocity where the body points") {
  for (const Backend backend : backends()) {
    SceneWorld w = empty_space();
    BodyMass sledge = solid(1, {1, 1, 1});
    w.add_body({{}, {Real(std::sqrt(0.5)), 0, 0, Real(std::sqrt(0.5))}, {0, 3, 0}, {}}, sledge);  // faces +y
    BodyMass shaft;
    shaft.inverse_inertia_B = {0, 1, 0};
    w.add_body({{5, 0, 0}, {}, {}, {}}, shaft);
    w.motor.push_back(speed_motor(w, 1, kWorld, {0, 1, 0}, 0, 0));
    Controller c = velocity_controller(ControllerType::velocity_by_speed, 5, 1e5);
    c.frame = ReferenceFrame::body;
    c.body = 0;
    c.proportional = 2;
    c.top_speed = 100;
    w.controller.push_back(c);
    const auto simulation = simulate(backend, w, {});
    simulation->advance(1);
    INFO(name_of(backend));
    CHECK(simulation->body(0, 1).angular_velocity.y == Approx(2 * (5 - 3)).epsilon(1e-4));
  }
}

TEST_CASE(
    "steering turns its arm against what a point ahead is beside the line, no further and no faster than it may") {
  for (const Backend backend : backends()) {
    // A body that faces 0.1 rad to the left and drifts to the right at 0.5 m/s.
    SceneWorld w = empty_space();
    w.add_body({{}, {Real(std::cos(0.05)), 0, 0, Real(std::sin(0.05))}, {2, Real(-0.5), 0}, {}},
               solid(1e6f, {1e6f, 1e6f, 1e6f}));
    w.add_body({{0, 5, 0}, {}, {}, {}}, solid(1, {1, 1, 1}));
    w.motor.push_back(speed_motor(w, 1, 0, {0, 0, 1}, 0, 0));
    Controller c;
    c.type = ControllerType::steering;
    c.body = 0;
    c.command = {{0, 1}};
    c.limit = {{0, 1e5}};
    c.proportional = 0.2;
    c.look_ahead = 4;
    c.max_angle = 0.3;
    c.rate = 20;
    c.top_speed = 1;
    c.pointer_a = {Real(std::cos(0.1)), Real(std::sin(0.1)), 0};
    w.controller.push_back(c);
    const auto simulation = simulate(backend, w, {});
    const auto angle = [&] {  // the arm's own turning; the body does not turn
      const Quat q = simulation->body(0, 1).orientation;
      return 2 * std::atan2(double(q.z), double(q.w));
    };
    const double ahead = 4 * std::sin(0.1);
    INFO(name_of(backend));
    advance_for(*simulation, 0.02);
    CHECK(angle() == Approx(-0.02).epsilon(1e-3));  // at its top speed towards -0.2 (ahead - 0.5 t)
    advance_for(*simulation, 0.98);
    // Behind a wish that grows at 0.1 rad/s by 0.1 / rate.
    CHECK(angle() == Approx(-0.2 * (ahead - 0.5) - 0.1 / 20).margin(5e-4));
    advance_for(*simulation, 9);
    CHECK(angle() == Approx(0.3).margin(1e-3));
  }
}

TEST_CASE("an arm is turned to the angle that is commanded, no further and no faster than it may") {
  for (const Backend backend : backends()) {
    SceneWorld w = empty_space();
    w.add_body({{}, {Real(std::cos(0.4)), 0, 0, Real(std::sin(0.4))}, {}, {}}, solid(1e6f, {1e6f, 1e6f, 1e6f}));
    w.add_body({{0, 5, 0}, {}, {}, {}}, solid(1, {1, 1, 1}));
    w.motor.push_back(speed_motor(w, 1, 0, {0, 0, 1}, 0, 0));
    Controller c;
    c.type = ControllerType::angle;
    c.command = {{0, 0}, {1, 0}};
    c.limit = {{0, 1e5}};
    c.max_angle = 0.3;
    c.rate = 20;
    c.top_speed = 1;
    c.pointer_a = {Real(std::cos(0.8)), Real(std::sin(0.8)), 0};
    w.controller.push_back(c);
    const auto simulation = simulate(backend, w, {});
    const auto angle = [&] {
      const Quat q = simulation->body(0, 1).orientation;
      return 2 * std::atan2(double(q.z), double(q.w));
    };
    INFO(name_of(backend));
    advance_for(*simulation, 0.1);
    CHECK(std::fabs(angle()) < 1e-6);
    simulation->set_command(0, 0, -0.2);
    advance_for(*simulation, 0.1);
    CHECK(angle() == Approx(-0.1).epsilon(1e-3));  // at its top speed
    advance_for(*simulation, 0.9);
    CHECK(angle() == Approx(-0.2).margin(1e-4));
    simulation->set_command(0, 0, 2);
    advance_for(*simulation, 3);
    CHECK(angle() == Approx(0.3).margin(1e-4));
    refused([&] { simulation->set_command(0, 0, std::nan("")); }, "controller 0");
    w.controller[0].rate = 0;
    refused([&] { simulate(backend, w, {}); }, "needs a rate");
  }
}

TEST_CASE("a command that is set holds in its own world, through a reordering of bodies, and until it is set again") {
  for (const Backend backend : backends()) {
    Controller c;
    c.type = ControllerType::throttle;
    c.command = {{0, 0}};
    c.limit = {{0, 2}, {1e6, 2}};
    StepSettings settings;
    settings.sort_every = 8;
    const auto simulation = make_simulation(backend, {flywheel(c), flywheel(c)}, settings, 1);
    simulation->set_command(1, 0, 0.5);
    advance_for(*simulation, 0.5);
    INFO(name_of(backend));
    CHECK(simulation->body(0, 0).angular_velocity.y == 0);
    CHECK(simulation->body(1, 0).angular_velocity.y == Approx(0.5 * 0.5 * 2 / kInertia).epsilon(1e-4));
    simulation->set_command(1, 0, -1);
    advance_for(*simulation, 0.25);
    CHECK(simulation->body(1, 0).angular_velocity.y == Approx(1 - 0.25 * 2 / kInertia).margin(1e-4));
    refused([&] { simulation->set_command(0, 0, 1.5); }, "takes no command");
  }
}

TEST_CASE("a step that has to be repeated with more memory for its contacts is driven once") {
  // 512 spheres with more than 8 neighbours each within the envelope: far more contacts than there is memory for.
  SceneWorld crowd = flywheel(velocity_controller(ControllerType::velocity_by_torque, 1, 100));
  crowd.controller[0].proportional = 1;
  crowd.controller[0].integral = 10;
  for (int i = 0; i < 512; ++i) crowd.add_sphere(Vec3d{5, 0, 0} + grid_place(i, 8, 8) * 0.1, 0.05f, 1000, 0);
  SceneWorld loners = empty_space();
  for (int i = 0; i < 3000; ++i) loners.add_sphere(Vec3d{-40, 0, 0} + grid_place(i, 100, 30) * 0.5, 0.05f, 1000, 0);
  StepSettings settings;
  settings.envelope = 0.05f;
  settings.iterations = 2;
  for (const Backend backend : backends()) {
    const auto tight = simulate(backend, crowd, settings),
               ample = make_simulation(backend, {crowd, loners}, settings, 1);
    for (const auto& s : {tight.get(), ample.get()}) s->advance(3);
    INFO(name_of(backend));
    CHECK(tight->report(0).contact_count > 4 * 513);
    CHECK(tight->report(0).contact_count < 4 * 3513);
    const double integral = tight->snapshot(0).element.controller[0].error_integral;
    CHECK(integral == Approx(3e-3));
    CHECK(integral == ample->snapshot(0).element.controller[0].error_integral);
  }
}

TEST_CASE("a controller without tables, out of order, with a second on its motor or a host on its wheel is refused") {
  Controller good;
  good.command = {{0, 1}};
  good.limit = {{0, 1}};
  const auto with = [&](auto&& change) {
    SceneWorld w = flywheel(good);
    change(w.controller[0]);
    return [w] { simulate(Backend::cpu, w, {}); };
  };
  refused(with([](Controller& c) { c.motor = 1; }), "controller 0 drives motor 1");
  refused(with([](Controller& c) { c.command.clear(); }), "no command table");
  SceneWorld torque = flywheel(good);
  torque.motor[0].kind = MotorKind::torque;
  refused([&] { simulate(Backend::cpu, torque, {}); }, "a torque motor");
  refused(with([](Controller& c) { c.limit = {{1, 2}, {1, 3}}; }), "not in ascending order");
  refused(with([](Controller& c) { c.limit = {{0, -2}}; }), "torque limit of -2");
  refused(with([](Controller& c) {
            c.type = ControllerType::throttle;
            c.command = {{0, 1.5}};
          }),
          "command of 1.5");
  refused(with([](Controller& c) {
            c.type = ControllerType::throttle;
            c.limit = {{0, 3}};
          }),
          "without a speed that the motor does not exceed");
  refused(with([](Controller& c) {
            c.type = ControllerType::held_speed;
            c.limit = {{-1, 3}, {1, 3}};
          }),
          "torque curve over negative speeds");
  refused(with([](Controller& c) { c.type = ControllerType::velocity_by_speed; }), "top speed");
  refused(with([](Controller& c) {
            c.type = ControllerType::velocity_by_torque;
            c.axis = {};
          }),
          "axis");
  refused(with([](Controller& c) {
            c.type = ControllerType::velocity_by_torque;
            c.body = 9;
          }),
          "follows body 9");
  SceneWorld twice = flywheel(good);
  twice.controller.push_back(good);
  refused([&] { simulate(Backend::cpu, twice, {}); }, "controller 1 drives motor 0, which has a controller");
  const auto simulation = simulate(Backend::cpu, flywheel(good), {});
  refused([&] { simulation->set_motor(0, 0, 1, 1); }, "set by a controller");
}
