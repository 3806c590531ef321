// Steered vehicles on hard ground: the turn that their linkage gives, and a driver who keeps to a line.
#include <algorithm>
#include <cmath>

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

TEST_CASE("steered wheels turn with their arms, and the vehicle turns about the point that its wheelbase gives") {
  const Vehicle v = smooth(shipped_vehicle("hmmwv"));
  DriverOrders orders;
  orders.speed = 2;
  HardGround d = steered(v, orders, 2);
  const double angle = 0.1;
  for (sim::Controller& c : d.world.controller) c.most_angle = angle;
  const auto s = started(d);
  shift_line(*s, 1000);  // full lock to the left
  advance_for(*s, 1.5);
  const auto before = s->bodies(0);
  const double turned = heading(before[std::size_t(d.e.chassis)], d.world.body[std::size_t(d.e.chassis)]);
  advance_for(*s, 1.5);
  const auto after = s->bodies(0);
  CHECK(agrees("drift of the joints [m]", 0, drift(d.world, after), 2e-4));
  const sim::BodyState& chassis = after[std::size_t(d.e.chassis)];
  const double yaw_rate = (heading(chassis, d.world.body[std::size_t(d.e.chassis)]) - turned) / 1.5;
  const double speed = std::hypot(double(chassis.velocity.x), double(chassis.velocity.y));
  // Rigid tyres that roll without side slip: the middle of the rear axle goes straight ahead, R = L / tan(angle).
  const double expected = speed * std::tan(angle) / 3.378;
  CHECK(agrees("yaw rate at 2 m/s, both wheels at 0.1 rad [rad/s]", expected, yaw_rate, 0.05 * expected));
}

TEST_CASE("a driver brings a HMMWV to a line beside it, and it stays there") {
  const Vehicle v = smooth(shipped_vehicle("hmmwv"));
  REQUIRE(steers(v));
  DriverOrders orders;
  orders.speed = 4;
  const HardGround d = steered(v, orders, 4);
  const auto s = started(d);
  shift_line(*s, 1);
  double most = 0;
  for (int k = 0; k < 50; ++k) {
    advance_for(*s, 0.2);
    most = std::max(most, s->body(0, d.e.chassis).position.y);
  }
  const sim::BodyState chassis = s->body(0, d.e.chassis);
  CHECK(agrees("beside the new line after 10 s [m]", 1, chassis.position.y, 0.05));
  CHECK(agrees("heading after 10 s [rad]", 0, heading(chassis, d.world.body[std::size_t(d.e.chassis)]), 0.02));
  CHECK(most < 1.25);
}
