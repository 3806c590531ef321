#include "vehicle/world/engine_vehicle.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/scene/scene.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

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
    const double width = v.track ? v.track->shoe_width : s.wheel->width;
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

Index axle_joint(const Assembly& a, int wheel_body) {
  for (std::size_t l = 0; l < a.link.size(); ++l)
    if (a.link[l].wheel && a.link[l].child == wheel_body) return Index(l);
  throw InputError("the wheel " + a.body[std::size_t(wheel_body)].name + " has no axle");
}

/// The hitch is as high as the axles, so that a pull turns the vehicle as its wheels' forces do.
void set_chassis(const sim::SceneWorld& world, const Vehicle& v, const Assembly& assembly, EngineVehicle& e) {
  e.chassis = e.bodies.body[0];
  e.chassis_centre = assembly.body[0].centre;
  const Vec3d hitch{-v.length / 2, 0, e.station.front().centre.z};
  e.hitch_B = rotate_back(world.body[std::size_t(e.chassis)].orientation, static_cast<Vec3>(hitch - e.chassis_centre));
}

/// A quarter: wheel and hub are one body of the whole quarter's mass along and across, and of their own along z; the
/// sprung mass keeps upright and moves along z alone, while the wheel turns and runs ahead.
EngineVehicle add_quarter(sim::SceneWorld& world, const Vehicle& v, const Vec3d& axle, int material, double yaw) {
  EngineVehicle e;
  e.station = stations(v);
  const Wheel& wheel = *e.station.front().wheel;
  double mass = wheel.part.mass + v.chassis.mass, carried = v.chassis.mass;
  for (const Part& p : v.fixed_parts) {
    mass += p.mass;
    carried += p.mass;
  }
  sim::BodyMass hub, sprung;
  hub.inverse_mass = {Real(1 / mass), Real(1 / mass), Real(1 / wheel.part.mass)};
  hub.inverse_inertia_B = {0, Real(1 / wheel.part.moments.y), 0};
  hub.isotropic = 0;
  sprung.inverse_mass = {0, 0, Real(1 / carried)};
  e.chassis = world.add_body({axle, {Real(std::cos(yaw / 2)), 0, 0, Real(std::sin(yaw / 2))}, {}, {}}, hub);
  e.wheel = {e.chassis};
  e.bodies.body = {world.add_body({axle + Vec3d{0, 0, 1}, {}, {}, {}}, sprung), e.chassis};
  sim::Shape tread;
  tread.type = sim::ShapeType::wheel;
  tread.body = e.chassis;
  tread.material = material;
  tread.size = {Real(wheel.radius), Real(wheel.width / 2), Real(wheel.lug_height)};
  tread.lug_count = wheel.lug_count;
  tread.lug_thickness = Real(wheel.lug_thickness);
  world.add_shape(tread);
  const Vec3d axis{0 - std::sin(yaw), std::cos(yaw), 0};
  e.drive_motor = {add_motor(world, sim::speed_motor(world, e.chassis, sim::kWorld, axis, 0, largest_drive_torque(v)))};
  e.brake_motor = {-1};
  const LinearSpring& strut = e.station.front().suspension->upright_spring;
  world.spring.push_back(sim::spring_along(world, e.chassis, e.bodies.body[0], axle, axle + Vec3d{0, 0, 1}, {0, 0, -1},
                                           strut.stiffness, strut.damping));
  return e;
}

/// Chassis, running gear and belts.
EngineVehicle add_tracked(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int material) {
  require_belt(v);
  const TrackLoop loops[2] = {close_loop(v, true), close_loop(v, false)};
  const Assembly assembly = assemble_without_belts(v, {loops[0].idler, loops[1].idler});
  EngineVehicle e{.station = stations(v), .bodies = add_bodies(world, assembly, origin)};
  add_struts(world, assembly, e.bodies, origin);
  set_chassis(world, v, assembly, e);
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
    const double width = v.track ? v.track->shoe_width : s.wheel->width;
    parts.push_back({.name = s.name,
                     .centre = s.centre,
                     .reach = ground_reach(v, *s.wheel),
                     .width = width,
                     .rolling_radius = s.wheel->radius,
                     .driven = s.driven && !v.track});
  }
  if (!v.track) return parts;
  const Track& t = *v.track;
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
  if (!v.track) return points;
  const Track& t = *v.track;
  for (const bool left : {true, false}) {
    const std::vector<Vec3d> pin = close_loop(v, left).pin;
    for (std::size_t k = 0; k < pin.size(); ++k) {
      const Vec3d way = pin[(k + 1) % pin.size()] - pin[k], out{way.z / t.shoe_pitch, 0, -way.x / t.shoe_pitch};
      if (out.z > -0.3) continue;  // faces forward, back or up
      const Vec3d from = pin[k] + (t.pad_below_pin + t.grouser_height) * out + Vec3d{0, left ? t.offset : -t.offset, 0};
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
  if (payload > 0)
    v.fixed_parts.push_back({.name = "payload", .mass = payload / v.payload_shares, .centre = v.chassis.centre});
  return v;
}

double loaded_mass(const Vehicle& v, double payload) { return weigh(v).total + payload / v.payload_shares; }

double ground_reach(const Vehicle& v, const Wheel& wheel) {
  if (!v.track) return wheel.radius + wheel.lug_height;
  const Track& t = *v.track;
  return pin_circle(t, wheel.radius) + t.pad_below_pin + t.grouser_height;
}

double standing_height(const Vehicle& v) {
  double height = -1e9;
  for (const Station& s : stations(v)) height = std::max(height, ground_reach(v, *s.wheel) - s.centre.z);
  return height;
}

double driven_wheel_inertia(const Vehicle& v) {
  if (v.track) return 2 * v.track->sprocket.moments.y;
  double sum = 0;
  for (const Station& s : stations(v))
    if (s.driven) sum += s.wheel->part.moments.y;
  return sum;
}

EngineVehicle add_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material,
                          double yaw) {
  if (is_quarter(v)) return add_quarter(world, v, origin, tool_material, yaw);
  if (v.kind == VehicleKind::tracked) return add_tracked(world, v, origin, tool_material);
  const Assembly assembly = assemble(v);
  EngineVehicle e{.station = stations(v), .bodies = add_bodies(world, assembly, origin)};
  add_struts(world, assembly, e.bodies, origin);
  set_chassis(world, v, assembly, e);
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

}  // namespace gonogo::vehicle
