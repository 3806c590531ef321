// Couplings and gearbox of a driveline against closed forms.
#include "sim/state/driveline.h"

#include <cmath>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Tables of a driveline in one array.
struct Plan {
  std::vector<TablePoint> points;
  DrivelinePlan d;
  Table add(const std::vector<TablePoint>& table) {
    const Table range{Index(points.size()), Index(table.size())};
    points.insert(points.end(), table.begin(), table.end());
    return range;
  }
  View<const TablePoint> view() { return {points.data(), Index(points.size())}; }
};

Plan one_gear(double ratio, const std::vector<TablePoint>& torque) {
  Plan p;
  p.d.torque = p.add(torque);
  p.d.gear_count = 1;
  p.d.ratio[0] = ratio;
  return p;
}

}  // namespace

TEST_CASE("a falling torque curve brings a free wheel to its zero without overshoot, however long the step") {
  // T = 100 (1 - w / 50) on 2 kg m^2 at the wheel side of ratio 4: w -> 12.5 rad/s.
  Plan p = one_gear(4, {{0, 100}, {100, -100}});
  p.d.wheel_inertia = 2;
  for (const double step : {1e-3, 0.05, 5.0}) {
    DrivelineState state;
    double w = 0;
    for (double t = 0; t < 40; t += step) {
      w += step * direct_torque(p.view(), p.d, 4, 1, w, step, state) / 2;
      CHECK(w <= 12.5 + 1e-9);
    }
    CHECK(agrees("speed after 40 s", 12.5, w, 1e-2));
  }
}

TEST_CASE("before a stalled converter the engine turns at the speed where its torque is what the converter takes") {
  Plan p = one_gear(10, {{0, 300}, {400, 300}});
  p.d.coupling = Coupling::converter;
  p.d.engine_inertia = 0.4;
  p.d.idle_speed = 60;
  p.d.efficiency = 0.9;
  p.d.torque_ratio = p.add({{0, 2}, {0.9, 1}, {1, 1}});
  p.d.capacity = p.add({{0, 0.01}, {1, 0}});
  DrivelineState state;
  double torque = 0;
  for (int k = 0; k < 5000; ++k) torque = converter_torque(p.view(), p.d, 10, 1, 0, 1e-3, state);
  CHECK(agrees("stall speed: sqrt(300 / 0.01) [rad/s]", std::sqrt(3e4), state.engine_speed, 0.01));
  CHECK(agrees("stall torque: 0.9 * 10 * 2 * 300 [N m]", 5400, torque, 1));
}

TEST_CASE("a slipping clutch passes its own torque, a closed one the engine's, and nothing is passed at idle") {
  Plan p = one_gear(5, {{0, 200}, {500, 200}});
  p.d.coupling = Coupling::clutch;
  p.d.engine_inertia = 0.3;
  p.d.idle_speed = 70;
  p.d.clutch_torque = 150;
  p.d.engaged_speed = 120;
  p.d.wheel_inertia = 3;
  DrivelineState state{0, 200, 0, 0};
  CHECK(agrees("slipping [N m]", 5 * 150, clutch_torque(p.view(), p.d, 5, 1, 0, 1e-3, state), 1e-9));
  state.engine_speed = 70;
  CHECK(agrees("at idle [N m]", 0, clutch_torque(p.view(), p.d, 5, 0, 0, 1e-3, state), 1e-9));
  // Closed on a heavy load that turns with it: the torque that is left after the engine's own inertia.
  p.d.clutch_torque = 1000;
  const double load = 400;
  double shaft = 40, torque = 0;
  state.engine_speed = 200;
  for (int k = 0; k < 2000; ++k) {
    torque = clutch_torque(p.view(), p.d, 5, 1, shaft, 1e-3, state);
    shaft += 1e-3 * torque / (load + 3);
  }
  const double expected = 5 * 200 * 403 / (403 + 25 * 0.3);
  CHECK(agrees("closed [N m]", expected, torque, 0.01 * expected));
  // It creeps by what a step's torque turns the bare wheels: h r^2 T / I.
  const double creep = 1e-3 * 25 * torque / 5 / 3;
  CHECK(agrees("engine turns with the shaft [rad/s]", 5 * shaft, state.engine_speed, creep));
}

TEST_CASE("gears change at their speeds and not sooner than the shift time after one another") {
  DrivelinePlan d;
  d.gear_count = 3;
  d.up_speed = 200;
  d.down_speed = 90;
  d.shift_time = 1;
  DrivelineState s{0, 250, 0, 0};
  shift(d, 5, s);
  CHECK(s.gear == 1);
  shift(d, 5.5, s);
  CHECK(s.gear == 1);
  shift(d, 6, s);
  shift(d, 7, s);
  CHECK(s.gear == 2);  // the highest
  s.engine_speed = 80;
  shift(d, 9, s);
  CHECK(s.gear == 1);
}

TEST_CASE("a driveline that cannot run is refused by its number and the reason") {
  SceneWorld w;
  w.size = {10, 10, 10};
  w.add_body({{5, 5, 5}, {}, {}, {}}, solid(1, {1, 1, 1}));
  w.motor.push_back(speed_motor(w, 0, kWorld, {0, 1, 0}, 0, 0));
  Driveline d;
  d.axle_count = d.gear_count = 1;
  d.axle[0].wheel[0] = 0;
  d.ratio[0] = 10;
  d.torque = d.throttle = {{0, 1}};
  d.braking = {{0, 0}};
  const auto run = [&](const Driveline& with) {
    w.driveline = {with};
    return simulate(Backend::cpu, w, settings_with(10));
  };
  const auto s = run(d);
  s->advance(100);
  CHECK(agrees("1 N m through a ratio of 10 for 0.1 s on 1 kg m^2 [rad/s]", 1, s->body(0, 0).angular_velocity.y, 1e-3));
  refused([&] { s->set_motor(0, 0, 1, 1); }, "controller");
  s->set_pedals(0, 0, 0.5, 0);
  s->advance(100);
  CHECK(agrees("and half of it for as long [rad/s]", 1.5, s->body(0, 0).angular_velocity.y, 1e-3));
  refused([&] { s->set_pedals(0, 0, -0.1, 0); }, "driveline 0");
  refused([&] { s->set_pedals(0, 0, 0, 2); }, "driveline 0");
  Driveline bad = d;
  bad.axle[0].share = 0.5;
  refused([&] { run(bad); }, "driveline 0");
  bad = d;
  bad.brake_count = 1;
  bad.brake[0] = {0, 5};
  refused([&] { run(bad); }, "driven already");
  bad = d;
  bad.coupling = Coupling::clutch;
  refused([&] { run(bad); }, "engine inertia");
}
