// Whole vehicles on hard ground in the contact engine against closed forms.
#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"
#include "tests/support/vehicles.h"
#include "vehicle/hard_ground/hard_ground.h"
#include "vehicle/model/statics.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

namespace {

Vehicle hmmwv() { return smooth(shipped_vehicle("hmmwv")); }

std::unique_ptr<sim::Simulation> started(sim::Backend backend, const sim::SceneWorld& world, double step = 1e-3) {
  sim::StepSettings settings = settings_with(50);
  settings.step = Real(step);
  return simulate(backend, world, settings);
}

double speed_of(sim::Simulation& s, const HardGround& d) { return s.body(0, d.e.chassis).velocity.x; }

void all_agree(const HardGroundReport& r) {
  CHECK(!r.check.empty());
  for (const HardGroundCheck& c : r.check) CHECK(agrees(c.claim, c.expected, c.measured, c.tolerance));
}

}  // namespace

TEST_CASE("the HMMWV's wheels carry what the balance of moments says") {
  for (const sim::Backend backend : backends()) all_agree(check_wheel_loads(hmmwv(), {backend, 1}));
}

TEST_CASE("a HMMWV climbs what friction allows: tan = mu when locked, 2 mu b / (L + 2 mu h) with an open centre") {
  all_agree(check_gradeability(hmmwv(), 0.5, {}));
}

TEST_CASE("the HMMWV's top speed in each gear is that at which the engine's torque vanishes") {
  for (const sim::Backend backend : backends()) all_agree(check_top_speeds(hmmwv(), {1, 2, 4}, {backend, 1}));
}

TEST_CASE("the HMMWV stops with locked wheels within v^2 / (2 mu g)") {
  for (const sim::Backend backend : backends()) all_agree(check_stopping(hmmwv(), 20, 0.4, {backend, 1}));
}

TEST_CASE("the HMMWV's heave and pitch frequencies are those of its mass on its static wheel rates") {
  all_agree(check_suspension(hmmwv(), {}));
}

TEST_CASE("the HMMWV shifts up through its gears and is in the one that its speed asks for") {
  const Vehicle v = hmmwv();
  const HardGround d(v, {}, 0.9);
  const auto s = started(sim::Backend::cpu, d.world, 2e-3);
  advance_for(*s, 4);
  const sim::DrivelineState now = s->snapshot(0).element.driveline.at(0);
  CHECK(now.gear >= 2);
  CHECK(now.engine_speed < 1.02 * v.driveline.up_speed);
  const double shaft = speed_of(*s, d) / 0.467;
  CHECK(agrees("engine speed from the road's [rad/s]", shaft * d.world.driveline[0].ratio[int(now.gear)],
               now.engine_speed, 0.03 * now.engine_speed));
}

TEST_CASE("a driver who holds a speed brings the HMMWV to it and keeps it there") {
  DriverOrders orders;
  orders.release = 0.3;
  orders.throttle_ramp = 1;
  orders.speed = 3;
  const HardGround d(hmmwv(), orders, 0.8, to_radians(10));
  const auto s = started(sim::Backend::cpu, d.world, 2e-3);
  advance_for(*s, 0.3);
  CHECK(std::fabs(speed_of(*s, d)) < 0.05);  // brakes on
  advance_for(*s, 8);
  CHECK(agrees("speed held up a slope of 10 deg [m/s]", 3, speed_of(*s, d), 0.1));
}

TEST_CASE("an Argo's driver lacks what the throttle takes, and soon lacks nothing") {
  // Full throttle pulls F, a slope takes W sin(theta) of it; a driver without patience gives that for a shortfall of
  // speed in the same proportion.
  const auto held = [](const Vehicle& driven, double seconds) {
    const Vehicle v = smooth(driven);
    DriverOrders orders;
    orders.release = 0.3;
    orders.throttle_ramp = 0.5;
    orders.speed = 1;
    const HardGround d(v, orders, 0.9, to_radians(15));
    const auto s = started(sim::Backend::cpu, d.world);
    advance_for(*s, seconds);
    return s->body(0, d.e.wheel[0]).angular_velocity.y * v.wheel.front().radius;
  };
  const Vehicle shipped = shipped_vehicle("argo_8x8");
  Vehicle without_patience = shipped;
  without_patience.driver.full_throttle_error = 2;
  without_patience.driver.integral_time = 1e4;
  const double share =
      weigh(shipped).total * kGravity * std::sin(to_radians(15)) / gear_speeds(shipped)[0].tractive_force;
  CHECK(
      agrees("speed of the rims of a driver who does not wait [m/s]", 1 - 2 * share, held(without_patience, 6), 0.01));
  CHECK(agrees("of the shipped one after 3 s [m/s]", 1, held(shipped, 3), 0.02));
}

TEST_CASE("a driver whose wheels find no hold turns them at the speed that he is told, and no faster") {
  const double speed = 3, mu = 0.05;  // up a slope that ten times as much would be needed on
  DriverOrders orders;
  orders.release = 0.3;
  orders.throttle_ramp = 0.5;
  orders.speed = speed;
  const Vehicle v = hmmwv();
  const HardGround d(v, orders, mu, to_radians(25));
  const auto s = started(sim::Backend::cpu, d.world, 1e-3);
  double fastest = 0;
  for (int k = 0; k < 300; ++k) {
    s->advance(10);
    double rim = 0;
    for (std::size_t i = 0; i < 4; ++i) rim += 0.25 * s->body(0, d.e.wheel[i]).angular_velocity.y * 0.467;
    fastest = std::fmax(fastest, rim);
    if (k == 299) CHECK(agrees("mean speed of the rims at the end [m/s]", speed, rim, 0.02 * speed));
  }
  CHECK(fastest < 1.3 * speed);
  CHECK(speed_of(*s, d) < 0);  // it slides back
  CHECK(s->snapshot(0).element.driveline.at(0).gear == 0);
}

TEST_CASE("an open axle spins its wheel on ice, a limited-slip one pulls by its bias, a locked one turns both alike") {
  // Rear-wheel drive on level ground, left wheels on ice: T_right / T_left <= bias with T_left = mu_ice N r.
  const double mu_ice = 0.1, mu = 0.8;
  const auto pull = [&](Differential differential, double bias) {
    Vehicle v = hmmwv();
    v.axle[0].driven = false;
    v.axle[1].differential = differential;
    v.axle[1].torque_bias = bias;
    DriverOrders orders;
    orders.release = 0.5;
    orders.gear = 1;
    HardGround d(v, orders, mu);
    for (sim::Shape& s : d.world.shape)
      if (s.body == d.e.wheel[2]) s.material = 2;
    d.world.set_law(0, 2, {Real(mu_ice), 0, 0});
    const auto s = started(sim::Backend::cpu, d.world);
    advance_for(*s, 3);
    double force = 0;
    for (int k = 0; k < 50; ++k) {
      s->advance(5);
      for (const int i : {2, 3}) force += s->contact_force(0, d.e.wheel[std::size_t(i)]).x / 50;
    }
    const auto spin = [&](const sim::Attachment& at) {
      const sim::BodyState body = s->body(0, at.body);
      return double(dot(body.angular_velocity, rotate(body.orientation, at.axis_B)));
    };
    for (const sim::Joint& j : d.world.joint)
      if (j.type == sim::JointType::equal_spin)
        CHECK(agrees("left wheel of a locked axle about its axis [rad/s]", spin(j.b), spin(j.a), 1e-4 * spin(j.b)));
    CHECK(std::ranges::count(d.world.joint, sim::JointType::equal_spin, &sim::Joint::type) ==
          (differential == Differential::locked));
    return force;
  };
  const double open = pull(Differential::open, 1), slip = pull(Differential::limited_slip, 3);
  pull(Differential::locked, 1);
  CHECK(agrees("pull with bias 3 over pull when open", 2, slip / open, 0.2));
}

TEST_CASE("wheel motors that are told their top speed climb at the one that their torque then holds") {
  // VIPER's motors: T = 300 (1 - w / 3.14) each. On a slope four of them carry m g sin(theta) r.
  const Vehicle v = smooth(shipped_vehicle("viper"));
  const double top = v.driveline.cut_speed, stall = v.driveline.efficiency * v.driveline.engine(0);
  const double radius = running_parts(v).front().rolling_radius, weight = weigh(v).total * kGravity;
  for (const double slope : {6.0, 12.0}) {
    DriverOrders orders;
    orders.throttle_ramp = 0.5;
    const HardGround d(v, orders, 0.9, to_radians(slope));
    const auto s = started(sim::Backend::cpu, d.world, 2e-3);
    advance_for(*s, 3);
    const double turns = s->body(0, d.e.wheel[0]).angular_velocity.y;
    const double expected = top * (1 - weight * std::sin(to_radians(slope)) * radius / (4 * stall));
    CHECK(agrees(line("turns of a wheel up %.0f degrees [rad/s]", slope), expected, turns, 0.02 * top));
  }
}

TEST_CASE("vehicles that the engine cannot drive are refused with the reason") {
  sim::SceneWorld w;
  Vehicle tracked = shipped_vehicle("m113");
  tracked.driveline.wheel_motors = true;
  refused([&] { HardGround(tracked, {}, 0.9); }, "wheel_motors");
  tracked.track->belt.reset();
  refused([&] { add_vehicle(w, tracked, {}, 1); }, "no track.belt");
  Vehicle v = hmmwv();
  v.driveline.centre = Differential::locked;
  refused([&] { HardGround(v, {}, 0.9); }, "centre differential");
  v = hmmwv();
  v.driveline.converter = {{0, 1}, {2, 1}};
  refused([&] { HardGround(v, {}, 0.9); }, "capacity");
}
