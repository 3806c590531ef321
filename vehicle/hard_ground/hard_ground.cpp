#include "vehicle/hard_ground/hard_ground.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "vehicle/hard_ground/drive_for.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

constexpr int kTyre = 1;          // material
constexpr double kClosed = 0.02;  // tolerance, relative
constexpr double kPeriod = 40;    // of the plane along x [m]

void add_plane(sim::SceneWorld& world) {
  sim::Shape s;
  s.type = sim::ShapeType::plane;
  s.body = world.add_body({}, sim::fixed_body());
  world.add_shape(s);
}

std::string per_cent(double x) { return std::to_string(int(std::lround(100 * x))); }

/// Means while the wheels spin.
struct Climb {
  double tangent = 0;                     // of the slope that would just be held
  double base = 0, rear = 0, height = 0;  // wheelbase; centre of mass before the rear axle, over the ground [m]
};

/// Adds where the vehicle's masses are now: on a slope it squats, the springs of its front axle extend.
void add_pose(sim::Simulation& s, const HardGround& ground, double share, Climb& c) {
  const auto bodies = s.bodies(0);
  double mass = 0, x = 0, z = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double inverse = ground.world.mass[i].inverse_mass.x;
    if (!(inverse > 0)) continue;
    mass += 1 / inverse;
    x += bodies[i].position.x / inverse;
    z += bodies[i].position.z / inverse;
  }
  const auto axle = [&](std::size_t left) {
    return 0.5 * (bodies[std::size_t(ground.e.wheel[left])].position.x +
                  bodies[std::size_t(ground.e.wheel[left + 1])].position.x);
  };
  const double rear = axle(ground.e.wheel.size() - 2);
  c.base += share * (axle(0) - rear);
  c.rear += share * (x / mass - rear);
  c.height += share * z / mass;
}

/// Full throttle on `slope`; what is left for acceleration tells which slope it would hold. In the lowest gear, because
/// a driver who shifts up ends where the engine, not the ground, is the limit. The wheels hop: hence the long mean.
Climb full_throttle(const Vehicle& v, double mu, double slope, const HardGroundRun& run, Trace& trace) {
  constexpr double settled = 2, time = 6, every = 0.02;  // [s]
  const int samples = int(std::lround(time / every));
  DriverOrders orders;
  orders.release = 0.5;
  orders.gear = 1;
  const HardGround ground(v, orders, mu, slope);
  const auto s = start(ground, run, 2e-3);
  drive_for(*s, settled);
  const double before = forward_speed(*s, ground);
  Climb c;
  for (int k = 0; k < samples; ++k) {
    drive_for(*s, every);
    add_pose(*s, ground, 1.0 / samples, c);
    trace.x.push_back(settled + (k + 1) * every);
    trace.y.push_back(forward_speed(*s, ground));
  }
  c.tangent = std::tan(slope) + (forward_speed(*s, ground) - before) / time / (kGravity * std::cos(slope));
  return c;
}

/// With balanced torques T = mu N r of both axles, N that of the front one: N L = m g (b cos - h sin).
double open_centre_limit(double mu, double base, double rear, double height) {
  return 2 * mu * rear / base / (1 + 2 * mu * height / base);
}

}  // namespace

HardGround::HardGround(const Vehicle& v, const DriverOrders& orders, double mu, double slope, double speed) {
  world.origin = {-kPeriod / 2, -10, -2};
  world.size = {Real(kPeriod), 20, 8};
  world.periodic_x = true;
  world.gravity = {Real(-kGravity * std::sin(slope)), 0, Real(-kGravity * std::cos(slope))};
  world.set_law(0, kTyre, {Real(mu), 0, 0});
  down = standing_height(v);
  e = add_vehicle(world, v, {0, 0, down}, kTyre);
  add_drive(world, v, e, orders);
  for (sim::BodyState& b : world.body) b.velocity = {Real(speed), 0, 0};
  for (std::size_t i = 0; i < e.wheel.size(); ++i)
    world.body[std::size_t(e.wheel[i])].angular_velocity = {0, Real(speed / e.station[i].wheel->radius), 0};
  add_plane(world);
}

Vehicle smooth(Vehicle v) {
  for (Wheel& w : v.wheel) {
    w.lug_count = 0;
    w.lug_height = 0;
  }
  return v;
}

Vehicle all_locked(Vehicle v) {
  for (Axle& a : v.axle) a.differential = Differential::locked;
  v.driveline.centre = Differential::locked;
  return v;
}

bool HardGroundCheck::holds() const { return std::fabs(measured - expected) <= tolerance; }

HardGroundReport check_wheel_loads(const Vehicle& vehicle, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  DriverOrders parked;
  parked.release = 100;
  const HardGround ground(v, parked, 0.8);
  const auto s = start(ground, run, 1e-3);
  drive_for(*s, 3);
  HardGroundReport r{.name = "wheel_loads",
                     .title = v.name + ": wheel loads on level ground",
                     .x_label = "wheel",
                     .y_label = "load [N]"};
  const auto expected = static_loads(v);
  Trace balance{"balance of forces and moments", {}, {}, true}, engine{"engine", {}, {}, true};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    double load = 0;
    const int samples = 50;
    for (int k = 0; k < samples; ++k) {
      s->advance(2);
      load += s->contact_force(0, ground.e.wheel[i]).z / samples;
    }
    std::string key = ground.e.station[i].name;
    std::replace(key.begin(), key.end(), ' ', '_');
    r.check.push_back({.key = "wheel_load_" + key + "_N",
                       .claim = "load of the wheel " + ground.e.station[i].name + " [N]",
                       .expected = expected[i],
                       .measured = load,
                       .tolerance = kClosed * expected[i]});
    balance.x.push_back(double(i + 1));
    balance.y.push_back(expected[i]);
    engine.x.push_back(double(i + 1));
    engine.y.push_back(load);
  }
  r.trace = {balance, engine};
  return r;
}

HardGroundReport check_gradeability(const Vehicle& vehicle, double mu, const HardGroundRun& run) {
  Vehicle v = all_locked(smooth(vehicle));
  HardGroundReport r{.name = "gradeability",
                     .title = v.name + ": speed at full throttle on the slope that friction just allows",
                     .x_label = "time [s]",
                     .y_label = "speed [m/s]"};
  r.trace = {{"all differentials locked", {}, {}}, {"open centre", {}, {}}};
  r.check.push_back({.key = "gradeability_locked",
                     .claim = "steepest slope with all differentials locked: tan = mu",
                     .expected = mu,
                     .measured = full_throttle(v, mu, std::atan(mu), run, r.trace[0]).tangent,
                     .tolerance = kClosed * mu});
  v.driveline.centre = Differential::open;
  const Weights w = weigh(v);
  const auto wheels = stations(v);
  const double design = open_centre_limit(mu, wheels.front().centre.x - wheels.back().centre.x,
                                          w.centre.x - wheels.back().centre.x, w.centre.z + standing_height(v));
  const Climb c = full_throttle(v, mu, std::atan(design), run, r.trace[1]);
  const double limit = open_centre_limit(mu, c.base, c.rear, c.height);
  r.check.push_back({.key = "gradeability_open_centre",
                     .claim = "steepest slope with an open centre, as it squats: tan = 2 mu b / (L + 2 mu h)",
                     .expected = limit,
                     .measured = c.tangent,
                     .tolerance = kClosed * limit});
  return r;
}

HardGroundReport check_top_speeds(const Vehicle& vehicle, const std::vector<int>& gears, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  HardGroundReport r{.name = "top_speed",
                     .title = v.name + ": full throttle in each gear",
                     .x_label = "time [s]",
                     .y_label = "speed [m/s]"};
  const auto speeds = gear_speeds(v);
  for (const int gear : gears) {
    const double expected = speeds[std::size_t(gear - 1)].balanced;
    DriverOrders orders;
    orders.gear = gear;
    const HardGround ground(v, orders, 0.9, 0, 0.96 * expected);
    const auto s = start(ground, run, 2e-3);
    Trace trace{"gear " + std::to_string(gear), {0}, {0.96 * expected}};
    for (int k = 0; k < 16; ++k) {
      drive_for(*s, 0.25);
      trace.x.push_back(0.25 * (k + 1));
      trace.y.push_back(forward_speed(*s, ground));
    }
    r.check.push_back({.key = "top_speed_gear_" + std::to_string(gear) + "_m_per_s",
                       .claim = "top speed in gear " + std::to_string(gear) + ": the engine's torque vanishes [m/s]",
                       .expected = expected,
                       .measured = trace.y.back(),
                       .tolerance = kClosed * expected});
    r.trace.push_back(trace);
  }
  return r;
}

HardGroundReport check_stopping(const Vehicle& vehicle, double speed, double mu, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  DriverOrders orders;
  orders.brake_from = 0.2;
  orders.speed = speed;  // held until then
  orders.gear = int(v.driveline.gears.size()) > 4 ? 5 : 0;
  HardGround ground(v, orders, mu, 0, speed);
  sim::Monitor m;
  m.body = ground.e.chassis;
  m.time_limit = 20;
  ground.world.monitor.push_back(m);
  const auto s = start(ground, run, 1e-3);
  drive_for(*s, orders.brake_from);
  const double from = s->monitor(0, 0).now.x, before = forward_speed(*s, ground);
  const double expected = before * before / (2 * mu * kGravity), time = before / (mu * kGravity) + 0.5;
  Trace trace{"engine", {0}, {before}}, closed{"v - mu g t", {0, before / (mu * kGravity)}, {before, 0}};
  for (int k = 0; k < 50; ++k) {
    drive_for(*s, time / 50);
    trace.x.push_back((k + 1) * time / 50);
    trace.y.push_back(forward_speed(*s, ground));
  }
  HardGroundReport r{.name = "stopping",
                     .title = v.name + ": locked wheels, mu " + per_cent(mu) + " %",
                     .x_label = "time from braking [s]",
                     .y_label = "speed [m/s]",
                     .trace = {closed, trace}};
  r.check.push_back({.key = "stopping_distance_m",
                     .claim = "stopping distance: v^2 / (2 mu g) [m]",
                     .expected = expected,
                     .measured = s->monitor(0, 0).now.x - from,
                     .tolerance = kClosed * expected});
  r.check.push_back({.key = "stopped_speed_m_per_s",
                     .claim = "speed half a second after it should have stopped [m/s]",
                     .expected = 0,
                     .measured = std::fabs(trace.y.back()),
                     .tolerance = 0.02});
  return r;
}

}  // namespace gonogo::vehicle
