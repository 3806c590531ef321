// Steered vehicles on hard ground: the turn that their linkage gives, and a driver who keeps to a line.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"
#include "tests/support/vehicles.h"
#include "vehicle/hard_ground/hard_ground.h"
#include "vehicle/world/driving.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

namespace {

/// Rolls along x on hard ground and steers.
HardGround steered(const Vehicle& v, const DriverOrders& orders, double speed) {
  HardGround d(v, orders, 0.8, 0, speed);
  const std::size_t made = d.world.body.size();
  add_steering(d.world, v, d.e, {0, 0, d.down});
  for (std::size_t i = made; i < d.world.body.size(); ++i) d.world.body[i].velocity = {Real(speed), 0, 0};
  return d;
}

/// Heading of a body that faced along x at the start [rad].
double heading(const sim::BodyState& now, const sim::BodyState& start) {
  const Vec3 forward = rotate(now.orientation, rotate_back(start.orientation, {1, 0, 0}));
  return std::atan2(double(forward.y), double(forward.x));
}

std::unique_ptr<sim::Simulation> started(const HardGround& d) {
  sim::StepSettings settings = settings_with(50);
  settings.step = 2e-3f;
  return simulate(sim::Backend::cpu, d.world, settings);
}

/// Moves the line that the driver keeps to by this much to the left [m].
void shift_line(sim::Simulation& s, double left) {
  sim::Snapshot snapshot = s.snapshot(0);
  for (sim::ControllerState& c : snapshot.element.controller) c.error_integral -= left;
  s.restore(0, snapshot);
}

}  // namespace

TEST_CASE("steered wheels turn as far as their arms, and the vehicle to that side") {
  const Vehicle v = smooth(shipped_vehicle("hmmwv"));
  DriverOrders orders;
  orders.speed = 2;
  HardGround d = steered(v, orders, 2);
  const double angle = 0.1;
  for (sim::Controller& c : d.world.controller) c.max_angle = angle;
  const auto s = started(d);
  shift_line(*s, 1000);  // full lock to the left
  advance_for(*s, 1.5);
  const auto before = s->bodies(0);
  const sim::BodyState& start = d.world.body[std::size_t(d.e.chassis)];
  const double turned = heading(before[std::size_t(d.e.chassis)], start);
  advance_for(*s, 1.5);
  const auto after = s->bodies(0);
  CHECK(agrees("drift of the joints [m]", 0, drift(d.world, after), 2e-4));
  const sim::BodyState& chassis = after[std::size_t(d.e.chassis)];
  const double now = heading(chassis, start);
  double steered_by = 0;
  for (const std::size_t wheel : {0, 1}) {  // in front; a wheel turns about its y axis
    const Vec3 axle = rotate(after[std::size_t(d.e.wheel[wheel])].orientation,
                             rotate_back(d.world.body[std::size_t(d.e.wheel[wheel])].orientation, {0, 1, 0}));
    steered_by += 0.5 * (std::atan2(-double(axle.x), double(axle.y)) - now);
  }
  // Kingpins lean, tie rods rise, and the vehicle stands lower than it was drawn: arm and wheel are parallel in the
  // drawing's plan view alone.
  CHECK(agrees("front wheels against the chassis, mean [rad]", angle, steered_by, 0.15 * angle));
  // Wheels that roll without side slip would turn it at v tan(angle) / L. Rigid treads touch with both their edges,
  // which scrub on a curve and hold some of that back.
  const double speed = std::hypot(double(chassis.velocity.x), double(chassis.velocity.y));
  const double rolling = speed * std::tan(angle) / 3.378;
  CHECK(agrees("yaw rate over that of rolling wheels", 0.8, (now - turned) / 1.5 / rolling, 0.2));
}

TEST_CASE("a driver brings a HMMWV to a line beside it, and it stays there") {
  const Vehicle v = smooth(shipped_vehicle("hmmwv"));
  REQUIRE(steers(v));
  DriverOrders orders;
  orders.speed = 4;
  const HardGround d = steered(v, orders, 4);
  const auto s = started(d);
  shift_line(*s, 1);
  double max = 0;
  for (int k = 0; k < 50; ++k) {
    advance_for(*s, 0.2);
    max = std::max(max, s->body(0, d.e.chassis).position.y);
  }
  const sim::BodyState chassis = s->body(0, d.e.chassis);
  // Treads that scrub (above) do not turn the vehicle at angles below some 0.03 rad, 0.13 m beside the line.
  CHECK(agrees("beside the new line after 10 s [m]", 1, chassis.position.y, 0.15));
  CHECK(agrees("heading after 10 s [rad]", 0, heading(chassis, d.world.body[std::size_t(d.e.chassis)]), 0.02));
  CHECK(max < 1.25);
}

TEST_CASE("on side slopes to the left and to the right a steering HMMWV runs ways that mirror each other") {
  const Vehicle v = smooth(shipped_vehicle("hmmwv"));
  DriverOrders orders;
  orders.speed = 3;
  std::vector<Vec3d> way[2];
  for (const int side : {0, 1}) {
    HardGround d = steered(v, orders, 3);
    const double across = to_radians(side == 0 ? 8 : -8);
    d.world.gravity = {0, Real(-kGravity * std::sin(across)), Real(-kGravity * std::cos(across))};
    const auto s = started(d);
    for (int k = 0; k < 15; ++k) {
      advance_for(*s, 0.2);
      const sim::BodyState chassis = s->body(0, d.e.chassis);
      way[side].push_back(
          {chassis.position.y, heading(chassis, d.world.body[std::size_t(d.e.chassis)]), double(chassis.velocity.x)});
    }
  }
  double beside = 0, turned = 0, speed = 0, max = 0;
  for (std::size_t k = 0; k < way[0].size(); ++k) {
    beside = std::max(beside, std::fabs(way[0][k].x + way[1][k].x));
    turned = std::max(turned, std::fabs(way[0][k].y + way[1][k].y));
    speed = std::max(speed, std::fabs(way[0][k].z - way[1][k].z));
    max = std::max(max, std::fabs(way[0][k].x));
  }
  CHECK(max > 0.005);  // the slope does push it aside
  CHECK(agrees("beside the line, sum of both [m]", 0, beside, 1e-3));
  CHECK(agrees("heading, sum of both [rad]", 0, turned, 1e-3));
  CHECK(agrees("speed, difference [m/s]", 0, speed, 5e-3));
}

namespace {

/// A vehicle that is driven by hand over level ground of friction 0.8.
struct ByHand {
  Vehicle v;
  sim::SceneWorld world;
  DrivenVehicle driven;
  std::unique_ptr<sim::Simulation> simulation;

  explicit ByHand(Vehicle vehicle) : v(std::move(vehicle)) {
    world.size = {200, 200, 20};
    world.origin = {-100, -100, -5};
    world.set_law(0, 1, {0.8f, 0, 0});
    add_plane(world);
    driven = add_driven_vehicle(world, v, {0, 0, standing_height(v)}, 1);
    sim::StepSettings settings = settings_with(50);
    settings.step = 2e-3f;
    simulation = simulate(sim::Backend::cpu, world, settings);
  }
  double heading_now() {
    return heading(simulation->body(0, driven.parts.chassis), world.body[std::size_t(driven.parts.chassis)]);
  }
  double speed() {
    const Vec3 v_W = simulation->body(0, driven.parts.chassis).velocity;
    return std::hypot(double(v_W.x), double(v_W.y));
  }
  void hold(double throttle, double steering, double seconds) {
    set_controls(*simulation, 0, driven, throttle, steering);
    advance_for(*simulation, seconds);
  }
};

}  // namespace

TEST_CASE("a hand-driven HMMWV accelerates, turns to both sides alike, and stops within v^2 / (2 mu g)") {
  double turned[2];
  for (const int side : {0, 1}) {
    ByHand d(smooth(shipped_vehicle("hmmwv")));
    REQUIRE(d.driven.steering == SteeringKind::wheels);
    CHECK(d.driven.arm.size() == 2);
    d.hold(0, 0, 0.5);
    CHECK(d.speed() < 0.05);
    d.hold(0.5, 0, 1);
    CHECK(d.speed() > 3);
    d.hold(0.2, side == 0 ? 0.5 : -0.5, 1);
    turned[side] = d.heading_now();
    const Vec3d from = d.simulation->body(0, d.driven.parts.chassis).position;
    const double speed = d.speed();
    d.hold(-1, 0, 2);
    CHECK(d.speed() < 0.1);
    const Vec3d way = d.simulation->body(0, d.driven.parts.chassis).position - from;
    CHECK(agrees("stopping distance over v^2 / (2 mu g)", 1,
                 std::hypot(way.x, way.y) / (speed * speed / (1.6 * kGravity)), 0.15));
  }
  CHECK(turned[0] > 0.3);
  CHECK(agrees("heading, sum of both sides [rad]", 0, turned[0] + turned[1], 0.02));
}

TEST_CASE("wheels behind the middle turn the other way, and wheel motors drive backwards") {
  ByHand d(smooth(shipped_vehicle("viper")));
  REQUIRE(d.driven.arm.size() == 4);
  d.hold(0, 1, 0.7);
  const auto now = d.simulation->bodies(0);
  const double chassis = d.heading_now();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto wheel = std::size_t(d.driven.parts.wheel[i]);
    const Vec3 axle = rotate(now[wheel].orientation, rotate_back(d.world.body[wheel].orientation, {0, 1, 0}));
    const double angle = std::atan2(-double(axle.x), double(axle.y)) - chassis;
    CHECK(agrees("angle of the wheel [rad]", i < 2 ? d.v.max_steering_angle : -d.v.max_steering_angle, angle, 0.08));
  }
  const double x = d.simulation->body(0, d.driven.parts.chassis).position.x;
  d.hold(-0.5, 0, 1);
  CHECK(d.simulation->body(0, d.driven.parts.chassis).position.x < x - 0.2);
}

TEST_CASE("a rover without steered wheels turns on the spot by its motors") {
  Vehicle v = smooth(shipped_vehicle("viper"));
  for (Axle& a : v.axle) a.steered = false;
  ByHand d(v);
  REQUIRE(d.driven.steering == SteeringKind::motors);
  d.hold(0, 0, 0.3);
  const Vec3d from = d.simulation->body(0, d.driven.parts.chassis).position;
  d.hold(0, 1, 2);
  const Vec3d way = d.simulation->body(0, d.driven.parts.chassis).position - from;
  CHECK(d.heading_now() > 0.2);
  CHECK(std::hypot(way.x, way.y) < 0.1);
  d.hold(0, -1, 2);
  CHECK(d.heading_now() < 0.2);
}

TEST_CASE("a vehicle that can do neither turns by the brakes of one side") {
  Vehicle v = smooth(shipped_vehicle("hmmwv"));
  for (Axle& a : v.axle) a.steered = false;
  for (const double side : {1.0, -1.0}) {
    ByHand d(v);
    REQUIRE(d.driven.steering == SteeringKind::brakes);
    d.hold(0.5, 0, 1.5);
    const double before = d.heading_now();
    d.hold(0.1, side, 1.5);
    CHECK(side * (d.heading_now() - before) > 0.05);
    CHECK_THROWS_AS(set_controls(*d.simulation, 0, d.driven, 1.1, 0), InputError);
    CHECK_THROWS_AS(set_controls(*d.simulation, 0, d.driven, 0, -2), InputError);
  }
}
