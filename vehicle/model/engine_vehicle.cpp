#include "vehicle/model/engine_vehicle.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/scene/build_joint.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

/// A locked differential passes on whatever its wheels need [N m].
constexpr double kLocked = 1e6;
/// Driver who holds a speed: full throttle at an error of 2 m/s, and the error's integral in five seconds.
constexpr double kProportional = 0.5, kIntegral = 0.1;  // [s/m], [1/m]

void add_wheel_shape(sim::SceneWorld& world, const Wheel& wheel, sim::BodyIndex body, int material) {
  const Quat& q = world.body[body].orientation;
  sim::Shape s;
  s.type = wheel.lug_count > 0 ? sim::ShapeType::wheel : sim::ShapeType::cylinder;
  s.body = body;
  s.material = material;
  s.size = {Real(wheel.radius), Real(wheel.width / 2), Real(wheel.lug_height)};
  s.lug_count = wheel.lug_count;
  s.lug_thickness = Real(wheel.lug_thickness);
  s.turn_B = {q.w, -q.x, -q.y, -q.z};  // its axle along the world's y
  world.add_shape(s);
}

/// The belly between the wheels, as a box that stands its clearance over the ground.
void add_belly(sim::SceneWorld& world, const Vehicle& v, const EngineVehicle& e, const Vec3d& origin, int material) {
  constexpr double height = 0.3, gap = 0.05;  // [m]
  double half_width = v.width / 2, front = -1e9, rear = 1e9;
  for (const Station& s : e.station) {
    const double width = v.track.empty() ? s.wheel->width : v.track[0].shoe_width;
    if (s.side != 0) half_width = std::min(half_width, std::fabs(s.centre.y) - width / 2 - gap);
    front = std::max(front, s.centre.x);
    rear = std::min(rear, s.centre.x);
  }
  if (!(half_width > 0) || !(v.length > 0)) return;
  const sim::BodyState& chassis = world.body[std::size_t(e.chassis)];
  const Vec3d middle = origin + Vec3d{(front + rear) / 2, 0, weigh(v).ground + v.clearance + height / 2};
  const Quat& q = chassis.orientation;
  sim::Shape s;
  s.type = sim::ShapeType::box;
  s.body = e.chassis;
  s.material = material;
  s.offset_B = rotate_back(q, static_cast<Vec3>(middle - chassis.position));
  s.size = {Real(v.length / 2), Real(half_width), Real(height / 2)};
  s.turn_B = {q.w, -q.x, -q.y, -q.z};
  world.add_shape(s);
}

std::vector<sim::TablePoint> points_of(const Curve& c, double factor = 1) {
  std::vector<sim::TablePoint> points;
  for (std::size_t i = 0; i < c.at.size(); ++i) points.push_back({c.at[i], factor * c.value[i]});
  return points;
}

/// Zero until `from`, one from `from` + `ramp` on.
std::vector<sim::TablePoint> ramp_up(double from, double ramp, double value) {
  return {{from, 0}, {from + std::max(ramp, 1e-6), value}};
}

Index axle_joint(const Assembly& a, int wheel_body) {
  for (std::size_t l = 0; l < a.link.size(); ++l)
    if (a.link[l].wheel && a.link[l].child == wheel_body) return Index(l);
  throw InputError("the wheel " + a.body[std::size_t(wheel_body)].name + " has no axle");
}

Index add_motor(sim::SceneWorld& world, const sim::Motor& motor) {
  world.motor.push_back(motor);
  return Index(world.motor.size()) - 1;
}

/// Stations of an axle, left before right.
std::vector<std::size_t> wheels_of(const EngineVehicle& e, int axle) {
  std::vector<std::size_t> wheels;
  for (std::size_t i = 0; i < e.station.size(); ++i)
    if (e.station[i].axle == axle) wheels.push_back(i);
  return wheels;
}

sim::DrivenAxle driven_axle(sim::SceneWorld& world, const Axle& axle, const EngineVehicle& e,
                            const std::vector<std::size_t>& wheels) {
  sim::DrivenAxle a;
  for (std::size_t k = 0; k < wheels.size(); ++k) a.wheel[k] = e.drive_motor[wheels[k]];
  if (wheels.size() < 2 || axle.differential == Differential::open) return a;
  a.lock = add_motor(world, sim::speed_motor(world, e.wheel[wheels[0]], e.wheel[wheels[1]], {0, 1, 0}, 0, 0));
  if (axle.differential == Differential::limited_slip) a.bias = axle.torque_bias;
  if (axle.differential == Differential::locked) a.lock_torque = kLocked;
  return a;
}

/// A locked centre differential between axles that are locked themselves holds all their wheels at equal speeds: motors
/// from the first of them to the others do that. Between open axles it would hold means of wheels, which no motor does.
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
  for (std::size_t k = 1; k < first.size(); ++k)
    add_motor(world, sim::speed_motor(world, first[0], first[k], {0, 1, 0}, 0, kLocked));
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

/// As the speedometer counts: of the first part that is driven [m].
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
  d.proportional = kProportional;
  d.integral = kIntegral;
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
    d.axle[a].share =
        d.axle_count == 2 ? (a == 0 ? v.driveline.front_share : 1 - v.driveline.front_share) : 1.0 / d.axle_count;
  set_driver(v, orders, world, e, d);
  world.driveline.push_back(d);
}

/// Torque of a wheel's motor over its speed up to the one that it does not exceed.
std::vector<sim::TablePoint> motor_limit(const Driveline& d) {
  std::vector<sim::TablePoint> points;
  for (const sim::TablePoint& p : points_of(d.engine, d.efficiency))
    if (p.at < d.cut_speed) points.push_back(p);
  points.push_back({d.cut_speed, d.efficiency * d.engine(d.cut_speed)});
  return points;
}

/// A motor in every driven wheel: holds the rim's speed within its torque; it brakes by holding zero. By hand it gives
/// a share of its torque.
void add_wheel_motors(sim::SceneWorld& world, const Vehicle& v, const EngineVehicle& e, const DriverOrders& orders) {
  const Curve& torque = v.driveline.engine;
  const double max_torque = *std::max_element(torque.value.begin(), torque.value.end()) * v.driveline.efficiency;
  for (std::size_t i = 0; i < e.station.size(); ++i) {
    if (e.drive_motor[i] < 0) continue;
    const double top = v.driveline.cut_speed, wish = orders.speed / e.station[i].wheel->radius;
    sim::Controller c;
    c.motor = e.drive_motor[i];
    c.command = ramp_up(orders.release, orders.throttle_ramp, orders.speed > 0 ? std::min(top, wish) : top);
    c.limit = {{0, max_torque}};
    if (orders.by_hand) {
      c.type = sim::ControllerType::throttle;
      c.command = {{0, 0}};
      c.limit = motor_limit(v.driveline);
    }
    world.controller.push_back(c);
  }
}

/// Chassis, running gear and belts.
EngineVehicle add_tracked(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int material) {
  require_belt(v);
  const TrackLoop loops[2] = {close_loop(v, true), close_loop(v, false)};
  const Assembly assembly = assemble_without_belts(v, {loops[0].idler, loops[1].idler});
  EngineVehicle e;
  e.station = stations(v);
  e.bodies = add_bodies(world, assembly, origin);
  add_struts(world, assembly, e.bodies, origin);
  e.chassis = e.bodies.body[0];
  e.chassis_centre = assembly.body[0].centre;
  add_belly(world, v, e, origin, material);
  add_sprockets_and_idlers(world, v, loops, assembly, e.bodies, material);
  world.set_law(material, material, {});  // see engine_track.h
  for (std::size_t i = 0; i < e.station.size(); ++i) {
    e.wheel.push_back(e.bodies.body[std::size_t(assembly.wheel[i])]);
    e.drive_motor.push_back(-1);
    e.brake_motor.push_back(-1);
    add_torsion_spring(world, e.station[i], assembly, assembly.wheel[i], e.bodies);
    add_double_wheel(world, v, e.wheel.back(), e.station[i].wheel->radius, e.station[i].wheel->width, material);
  }
  for (std::size_t k = 0; k < 2; ++k)
    e.track.push_back(add_belt(world, v, k == 0 ? 1 : -1, loops[k], assembly, e.bodies, origin, material));
  return e;
}

}  // namespace

std::vector<RunningPart> running_parts(const Vehicle& v) {
  std::vector<RunningPart> parts;
  for (const Station& s : stations(v)) {
    const double width = v.track.empty() ? s.wheel->width : v.track[0].shoe_width;
    parts.push_back({.name = s.name,
                     .centre = s.centre,
                     .reach = ground_reach(v, *s.wheel),
                     .width = width,
                     .rolling_radius = s.wheel->radius,
                     .driven = s.driven && v.track.empty()});
  }
  for (const Track& t : v.track)
    for (const double side : {1.0, -1.0})
      parts.push_back({.name = side > 0 ? "left sprocket" : "right sprocket",
                       .centre = t.sprocket.centre + Vec3d{0, side * t.offset, 0},
                       .rolling_radius = rolling_radius(t),
                       .driven = true});
  return parts;
}

std::vector<Vec3d> belt_bottom(const Vehicle& v) {
  constexpr double every = 0.01;  // [m]
  std::vector<Vec3d> points;
  for (const Track& t : v.track)
    for (const bool left : {true, false}) {
      const std::vector<Vec3d> pin = close_loop(v, left).pin;
      for (std::size_t k = 0; k < pin.size(); ++k) {
        const Vec3d way = pin[(k + 1) % pin.size()] - pin[k], out{way.z / t.shoe_pitch, 0, -way.x / t.shoe_pitch};
        if (out.z > -0.3) continue;  // faces forward, back or up
        const Vec3d from =
            pin[k] + (t.pad_below_pin + t.grouser_height) * out + Vec3d{0, left ? t.offset : -t.offset, 0};
        for (double s = 0; s < t.shoe_pitch; s += every) points.push_back(from + (s / t.shoe_pitch) * way);
      }
    }
  return points;
}

sim::BodyIndex running_body(const EngineVehicle& e, std::size_t part) {
  return part < e.wheel.size() ? e.wheel[part] : e.track[part - e.wheel.size()].sprocket;
}

Index running_motor(const EngineVehicle& e, std::size_t part) {
  return part < e.wheel.size() ? e.drive_motor[part] : e.track[part - e.wheel.size()].drive_motor;
}

Vehicle loaded(Vehicle v, double payload) {
  if (payload > 0) v.fixed_parts.push_back({.name = "payload", .mass = payload, .centre = v.chassis.centre});
  return v;
}

double ground_reach(const Vehicle& v, const Wheel& wheel) {
  if (v.track.empty()) return wheel.radius + wheel.lug_height;
  const Track& t = v.track[0];
  return pin_circle(t, wheel.radius) + t.pad_below_pin + t.grouser_height;
}

double standing_height(const Vehicle& v) {
  double height = -1e9;
  for (const Station& s : stations(v)) height = std::max(height, ground_reach(v, *s.wheel) - s.centre.z);
  return height;
}

double driven_wheel_inertia(const Vehicle& v) {
  if (v.kind == VehicleKind::tracked) return 2 * v.track[0].sprocket.moments.y;
  double sum = 0;
  for (const Station& s : stations(v))
    if (s.driven) sum += s.wheel->part.moments.y;
  return sum;
}

EngineVehicle add_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material) {
  if (v.kind == VehicleKind::tracked) return add_tracked(world, v, origin, tool_material);
  const Assembly assembly = assemble(v);
  EngineVehicle e;
  e.station = stations(v);
  e.bodies = add_bodies(world, assembly, origin);
  add_struts(world, assembly, e.bodies, origin);
  e.chassis = e.bodies.body[0];
  e.chassis_centre = assembly.body[0].centre;
  add_belly(world, v, e, origin, tool_material);
  for (std::size_t i = 0; i < e.station.size(); ++i) {
    const int body = assembly.wheel[i];
    e.wheel.push_back(e.bodies.body[std::size_t(body)]);
    add_wheel_shape(world, *e.station[i].wheel, e.wheel[i], tool_material);
    const sim::Joint& axle = world.joint[std::size_t(e.bodies.joint[std::size_t(axle_joint(assembly, body))])];
    e.drive_motor.push_back(e.station[i].driven ? add_motor(world, sim::speed_motor(axle, 0, 0)) : -1);
    e.brake_motor.push_back(e.station[i].brake_torque > 0 ? add_motor(world, sim::speed_motor(axle, 0, 0)) : -1);
  }
  return e;
}

void add_drive(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const DriverOrders& orders) {
  if (v.driveline.wheel_motors && !e.track.empty())
    throw InputError("vehicle " + v.name +
                     ": driveline.type is wheel_motors; trials drive tracks by an engine, give \"engine\"");
  if (v.driveline.wheel_motors)
    add_wheel_motors(world, v, e, orders);
  else
    add_engine(world, v, e, orders);
}

}  // namespace gonogo::vehicle
