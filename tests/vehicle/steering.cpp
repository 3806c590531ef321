// Steered vehicles on hard ground: the turn that their linkage gives, and a driver who keeps to a line.
#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"
#include "tests/support/vehicles.h"
#include "vehicle/hard_ground/hard_ground.h"

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
