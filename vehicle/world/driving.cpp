#include "vehicle/world/driving.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/scene/scene.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

// Driveline.

std::vector<sim::TablePoint> points_of(const Curve& c, double factor = 1) {
  std::vector<sim::TablePoint> points;
  for (std::size_t i = 0; i < c.at.size(); ++i) points.push_back({c.at[i], factor * c.value[i]});
  return points;
}

/// Zero until `from`, one from `from` + `ramp` on.
std::vector<sim::TablePoint> ramp_up(double from, double ramp, double value) {
  return {{from, 0}, {from + std::max(ramp, 1e-6), value}};
}

/// Stations of an axle, left before right.
std::vector<std::size_t> wheels_of(const EngineVehicle& e, int axle) {
  std::vector<std::size_t> wheels;
  for (std::size_t i = 0; i < e.station.size(); ++i)
    if (e.station[i].axle == axle) wheels.push_back(i);
  return wheels;
}

/// Wheels behind a locked differential. A joint, not a motor: with one update a substep, a chain of strong motors
/// rings.
void hold_together(sim::SceneWorld& world, sim::BodyIndex a, sim::BodyIndex b) {
  world.joint.push_back(sim::equal_spin(world, a, b, {0, 1, 0}, {0, 1, 0}));
}

sim::DrivenAxle driven_axle(sim::SceneWorld& world, const Axle& axle, const EngineVehicle& e,
                            const std::vector<std::size_t>& wheels) {
  sim::DrivenAxle a;
  for (std::size_t k = 0; k < wheels.size(); ++k) a.wheel[k] = e.drive_motor[wheels[k]];
  if (wheels.size() < 2) return a;
  const sim::BodyIndex left = e.wheel[wheels[0]], right = e.wheel[wheels[1]];
  if (axle.differential == Differential::locked) hold_together(world, left, right);
  if (axle.differential != Differential::limited_slip) return a;
  a.lock = add_motor(world, sim::speed_motor(world, left, right, {0, 1, 0}, 0, 0));
  a.bias = axle.torque_bias;
  return a;
}

/// A locked centre differential between axles that are locked themselves holds all their wheels together. Between open
/// axles it would hold means of wheels, which no joint does.
void lock_centre(sim::SceneWorld& world, const Vehicle& v, const EngineVehicle& e) {
  if (v.driveline.centre == Differential::open) return;
  std::vector<sim::BodyIndex> first;
  bool locked = v.driveline.centre == Differential::locked;
  for (std::size_t a = 0; a < v.axle.size(); ++a) {
    if (!v.axle[a].driven) continue;
    first.push_back(e.wheel[wheels_of(e, int(a))[0]]);
    locked = locked && v.axle[a].differential == Differential::locked;
  }
  if (!locked)
    throw InputError("vehicle " + v.name +
                     ": trials drive a centre differential that is open, or locked with all driven axles locked too");
  for (std::size_t k = 1; k < first.size(); ++k) hold_together(world, first[0], first[k]);
}

void set_coupling(const Vehicle& v, sim::Driveline& d) {
  const Driveline& from = v.driveline;
  d.engine_inertia = from.engine_inertia;
  d.idle_speed = from.idle_speed;
  if (!from.converter.empty()) {
    if (from.converter_capacity.empty())
      throw InputError("vehicle " + v.name +
                       ": its torque converter has no capacity_N_m_s2; a trial needs it, with "
                       "engine_inertia_kg_m2, to know how fast the engine turns");
    d.coupling = sim::Coupling::converter;
    d.torque_ratio = points_of(from.converter);
    d.capacity = points_of(from.converter_capacity);
  } else if (from.clutch_torque > 0) {
    d.coupling = sim::Coupling::clutch;
    d.clutch_torque = from.clutch_torque;
    d.engaged_speed = from.engaged_speed;
  }
}

void set_gears(const Vehicle& v, int gear, sim::Driveline& d) {
  std::vector<double> output = v.driveline.gears;
  std::sort(output.begin(), output.end());
  if (int(output.size()) > sim::kMaxGears || gear > int(output.size()))
    throw InputError("vehicle " + v.name + " has " + std::to_string(output.size()) + " gears; at most " +
                     std::to_string(sim::kMaxGears) + " can be driven, and a gear to stay in must be one of them");
  for (const double g : output) d.ratio[d.gear_count++] = 1 / (g * v.driveline.final_drive);
  d.first_gear = gear > 0 ? gear - 1 : 0;
  if (gear > 0) return;
  d.up_speed = v.driveline.up_speed;
  d.down_speed = v.driveline.down_speed;
  d.shift_time = v.driveline.shift_time;
}

/// Way per radian that the speedometer counts: that of the first driven part [m].
double way_per_radian(const Vehicle& v) {
  for (const RunningPart& p : running_parts(v))
    if (p.driven) return p.rolling_radius;
  return 0;
}

void set_driver(const Vehicle& v, const DriverOrders& orders, const sim::SceneWorld& world, const EngineVehicle& e,
                sim::Driveline& d) {
  if (orders.by_hand) {
    d.throttle = d.braking = {{0, 0}};
    d.body = e.chassis;
    return;
  }
  const double end = std::max(orders.brake_from, orders.release + orders.throttle_ramp + 2e-3), moment = 1e-3;
  d.throttle = ramp_up(orders.release, orders.speed > 0 ? 0 : orders.throttle_ramp, 1);
  d.throttle.insert(d.throttle.end(), {{end, 1}, {end + moment, 0}});
  d.braking = {{orders.release, 1}, {orders.release + moment, 0}, {end, 0}, {end + moment, 1}};
  if (orders.release <= 0) d.braking.erase(d.braking.begin(), d.braking.begin() + 2);
  if (orders.speed > 0) d.speed = ramp_up(orders.release, orders.throttle_ramp, orders.speed);
  d.way_per_radian = way_per_radian(v);
  d.body = e.chassis;
  d.axis_B = rotate_back(world.body[std::size_t(e.chassis)].orientation, {1, 0, 0});
  d.proportional = 1 / v.driver.full_throttle_error;
  d.integral = d.proportional / v.driver.integral_time;
  for (std::size_t i = 0; i < e.station.size(); ++i)
    if (e.brake_motor[i] >= 0) d.brake[d.brake_count++] = {e.brake_motor[i], e.station[i].brake_torque};
  for (const EngineTrack& t : e.track) d.brake[d.brake_count++] = {t.brake_motor, t.brake_torque};
}

void add_engine(sim::SceneWorld& world, const Vehicle& v, const EngineVehicle& e, const DriverOrders& orders) {
  lock_centre(world, v, e);
  sim::Driveline d;
  d.torque = points_of(v.driveline.engine);
  d.efficiency = v.driveline.efficiency;
  d.wheel_inertia = driven_wheel_inertia(v);
  set_coupling(v, d);
  set_gears(v, orders.gear, d);
  for (std::size_t a = 0; a < v.axle.size(); ++a) {
    if (!v.axle[a].driven) continue;
    if (d.axle_count == sim::kMaxDrivenAxles)
      throw InputError("vehicle " + v.name + ": at most " + std::to_string(sim::kMaxDrivenAxles) +
                       " axles can be driven");
    d.axle[d.axle_count++] = driven_axle(world, v.axle[a], e, wheels_of(e, int(a)));
  }
  if (!e.track.empty()) {
    d.axle_count = 1;
    for (std::size_t k = 0; k < 2; ++k) d.axle[0].wheel[k] = e.track[k].drive_motor;
  }
  for (Index a = 0; a < d.axle_count; ++a)
    d.axle[a].share = torque_share(v.driveline, std::size_t(a), std::size_t(d.axle_count));
  set_driver(v, orders, world, e, d);
  world.driveline.push_back(d);
}

/// Torque of a wheel's motor over its speed up to the one that it does not exceed, if any.
std::vector<sim::TablePoint> motor_limit(const Driveline& d) {
  std::vector<sim::TablePoint> points;
  for (const sim::TablePoint& p : points_of(d.engine, d.efficiency))
    if (p.at < d.cut_speed) points.push_back(p);
  if (std::isfinite(d.cut_speed)) points.push_back({d.cut_speed, d.efficiency * d.engine(d.cut_speed)});
  return points;
}

/// A motor in every driven wheel: holds the rim's speed within its torque at that speed; it brakes by holding zero. By
/// hand it gives a share of its torque.
void add_wheel_motors(sim::SceneWorld& world, const Vehicle& v, const EngineVehicle& e, const DriverOrders& orders) {
  for (std::size_t i = 0; i < e.station.size(); ++i) {
    if (e.drive_motor[i] < 0) continue;
    const double top = v.driveline.cut_speed, wish = orders.speed / e.station[i].wheel->radius;
    sim::Controller c;
    c.type = orders.by_hand ? sim::ControllerType::throttle : sim::ControllerType::held_speed;
    c.motor = e.drive_motor[i];
    c.command = ramp_up(orders.release, orders.throttle_ramp, orders.speed > 0 ? std::min(top, wish) : top);
    if (orders.by_hand) c.command = {{0, 0}};
    c.limit = motor_limit(v.driveline);
    world.controller.push_back(c);
  }
}

// Steering.

/// Middle of an upright's ball joints [m].
Vec3d kingpin(const Assembly& a, int upright) {
  Vec3d sum;
  int count = 0;
  for (const Link& l : a.link)
    if (l.type == LinkType::spherical && l.child == upright) {
      sum += l.point;
      ++count;
    }
  return sum * (1.0 / std::max(count, 1));
}

/// The steered axle whose wheel turns in this upright; null for others.
const Axle* steered_axle(const Vehicle& v, const Assembly& a, const EngineVehicle& e, int upright) {
  for (const Link& l : a.link)
    for (std::size_t i = 0; l.wheel && l.parent == upright && i < e.station.size(); ++i)
      if (a.wheel[i] == l.child && v.axle[std::size_t(e.station[i].axle)].steered)
        return &v.axle[std::size_t(e.station[i].axle)];
  return nullptr;
}

/// Arm from its pivot in the chassis to the inner end of the tie rod of this link. Returns a controller of its motor
/// without type and command.
sim::Controller add_steering_arm(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const Link& tie_rod,
                                 Index joint, const Vec3d& lever, const Vec3d& origin) {
  constexpr double mass = 0.5, moment = 0.01, torque = 5000;  // light and strong [kg], [kg m^2], [N m]
  constexpr double rate = 10, top_speed = 1;                  // of the driver's hands [1/s], [rad/s]
  const Vec3d inner = origin + tie_rod.parent_point, pivot = inner - lever;
  const sim::BodyIndex arm = world.add_body({pivot + 0.5 * lever, {}, {}, {}},
                                            sim::solid(Real(mass), {Real(moment), Real(moment), Real(moment)}));
  world.joint.push_back(sim::revolute(world, arm, e.chassis, pivot, {0, 0, 1}));
  const sim::BodyIndex upright = e.bodies.body[std::size_t(tie_rod.child)];
  world.motor.push_back(sim::speed_motor(world.joint.back(), 0, torque));
  e.steer_motor.push_back(Index(world.motor.size()) - 1);
  world.joint[std::size_t(joint)] = sim::distance(world, upright, arm, origin + tie_rod.point, inner);
  sim::Controller c;
  c.motor = e.steer_motor.back();
  c.body = e.chassis;
  c.axis = rotate_back(world.body[std::size_t(e.chassis)].orientation, {1, 0, 0});
  c.limit = {{0, torque}};
  c.max_angle = v.max_steering_angle;
  c.rate = rate;
  c.top_speed = top_speed;
  return c;
}

/// Adds an arm for every steered wheel; `finish` gets its axle and controller.
template <class Finish>
void add_arms(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const Vec3d& origin, const Finish& finish) {
  const Assembly assembly = assemble(v);
  for (std::size_t l = 0; l < assembly.link.size(); ++l) {
    const Link& tie_rod = assembly.link[l];
    if (tie_rod.type != LinkType::distance) continue;
    const Axle* axle = steered_axle(v, assembly, e, tie_rod.child);
    if (axle == nullptr) continue;
    Vec3d lever = tie_rod.point - kingpin(assembly, tie_rod.child);
    lever.z = 0;
    sim::Controller c = add_steering_arm(world, v, e, tie_rod, e.bodies.joint[l], lever, origin);
    finish(*axle, c);
    world.controller.push_back(c);
  }
}

/// Whether some wheels turn on kingpins that tie rods hold, and the file says how far.
bool has_steered_wheels(const Vehicle& v) {
  return v.max_steering_angle > 0 && std::any_of(v.axle.begin(), v.axle.end(), [&](const Axle& a) {
           return a.steered && find_suspension(v, a.suspension).type == SuspensionType::double_wishbone;
         });
}

// By hand.

/// Adds arms that hold the angles that sim::Simulation::set_command() gives their controllers [rad].
std::vector<Control> add_hand_steering(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e,
                                       const Vec3d& origin) {
  const auto [rear, front] = std::minmax_element(
      v.axle.begin(), v.axle.end(), [](const Axle& a, const Axle& b) { return a.position.x < b.position.x; });
  const double middle = (rear->position.x + front->position.x) / 2;
  std::vector<Control> arms;
  add_arms(world, v, e, origin, [&](const Axle& axle, sim::Controller& c) {
    c.type = sim::ControllerType::angle;
    c.command = {{0, 0}};
    arms.push_back({Index(world.controller.size()), axle.position.x < middle ? -1.0 : 1.0, v.max_steering_angle});
  });
  return arms;
}

void check_share(const char* name, double x) {
  if (!(x >= -1 && x <= 1))
    throw InputError(std::string(name) + ": " + std::to_string(x) + " given; allowed are -1 to 1");
}

std::vector<Control> brakes_of(const EngineVehicle& e) {
  std::vector<Control> brakes;
  for (std::size_t i = 0; i < e.station.size(); ++i)
    if (e.brake_motor[i] >= 0) brakes.push_back({e.brake_motor[i], e.station[i].side, e.station[i].brake_torque});
  for (std::size_t k = 0; k < e.track.size(); ++k)
    brakes.push_back({e.track[k].brake_motor, k == 0 ? 1.0 : -1.0, e.track[k].brake_torque});
  return brakes;
}

/// Controllers that add_driveline() added, one for each driven wheel.
std::vector<Control> motors_of(const EngineVehicle& e, std::size_t first_controller) {
  std::vector<Control> motors;
  for (std::size_t i = 0; i < e.station.size(); ++i)
    if (e.drive_motor[i] >= 0) motors.push_back({Index(first_controller + motors.size()), e.station[i].side, 1});
  return motors;
}

}  // namespace

void add_driveline(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const DriverOrders& orders) {
  if (v.driveline.wheel_motors && !e.track.empty())
    throw InputError("vehicle " + v.name +
                     ": driveline.type is wheel_motors; trials drive tracks by an engine, give \"engine\"");
  if (v.driveline.wheel_motors)
    add_wheel_motors(world, v, e, orders);
  else
    add_engine(world, v, e, orders);
}

bool steers(const Vehicle& v) { return v.driver.look_ahead > 0 && v.driver.steering_gain > 0 && has_steered_wheels(v); }

void add_steering(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const Vec3d& origin) {
  add_arms(world, v, e, origin, [&](const Axle&, sim::Controller& c) {
    c.type = sim::ControllerType::steering;
    c.command = {{0, 1}};
    c.proportional = v.driver.steering_gain;
    c.look_ahead = v.driver.look_ahead;
  });
}

std::string name_of(SteeringKind kind) {
  switch (kind) {
    case SteeringKind::wheels:
      return "wheels";
    case SteeringKind::motors:
      return "motors";
    case SteeringKind::brakes:
      return "brakes";
    case SteeringKind::none:
      break;
  }
  return "none";
}

SteeringKind steering_of(const Vehicle& v) {
  if (has_steered_wheels(v)) return SteeringKind::wheels;
  if (v.driveline.wheel_motors) return SteeringKind::motors;
  const auto stopped = stations(v);
  const bool brakes = v.track || std::any_of(stopped.begin(), stopped.end(),
                                             [](const Station& s) { return s.brake_torque > 0 && s.side != 0; });
  return brakes ? SteeringKind::brakes : SteeringKind::none;
}

DrivenVehicle add_driven_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material) {
  DrivenVehicle d{.parts = add_vehicle(world, v, origin, tool_material), .steering = steering_of(v)};
  if (d.steering == SteeringKind::wheels) d.arm = add_hand_steering(world, v, d.parts, origin);
  const std::size_t controllers = world.controller.size();
  DriverOrders orders;
  orders.by_hand = true;
  add_driveline(world, v, d.parts, orders);
  if (v.driveline.wheel_motors)
    d.motor = motors_of(d.parts, controllers);
  else
    d.driveline = Index(world.driveline.size()) - 1;
  d.brake = brakes_of(d.parts);
  return d;
}

void set_controls(sim::Simulation& simulation, sim::WorldIndex world, const DrivenVehicle& v, double throttle,
                  double steering) {
  check_share("throttle", throttle);
  check_share("steering", steering);
  const double by_motors = v.steering == SteeringKind::motors ? steering : 0,
               by_brakes = v.steering == SteeringKind::brakes ? steering : 0;
  if (v.driveline >= 0) simulation.set_pedals(world, v.driveline, std::max(throttle, 0.0), 0);
  for (const Control& m : v.motor)
    simulation.set_command(world, m.index, std::clamp(throttle - m.side * by_motors, -1.0, 1.0));
  for (const Control& a : v.arm) simulation.set_command(world, a.index, a.side * steering * a.max);
  const double all = v.driveline >= 0 ? std::max(-throttle, 0.0) : 0;
  for (const Control& b : v.brake)
    simulation.set_motor(world, b.index, 0, Real(b.max * std::max(all, b.side * by_brakes)));
}

}  // namespace gonogo::vehicle
