#include <algorithm>

#include "sim/scene/build_joint.h"
#include "vehicle/model/engine_vehicle.h"

namespace gonogo::vehicle {
namespace {

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

}  // namespace

bool has_steered_wheels(const Vehicle& v) {
  return v.max_steering_angle > 0 && std::any_of(v.axle.begin(), v.axle.end(), [&](const Axle& a) {
           return a.steered && find_suspension(v, a.suspension).type == SuspensionType::double_wishbone;
         });
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

std::vector<SteeredArm> add_hand_steering(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e,
                                          const Vec3d& origin) {
  const auto [rear, front] = std::minmax_element(
      v.axle.begin(), v.axle.end(), [](const Axle& a, const Axle& b) { return a.position.x < b.position.x; });
  const double middle = (rear->position.x + front->position.x) / 2;
  std::vector<SteeredArm> arms;
  add_arms(world, v, e, origin, [&](const Axle& axle, sim::Controller& c) {
    c.type = sim::ControllerType::angle;
    c.command = {{0, 0}};
    arms.push_back({Index(world.controller.size()), axle.position.x < middle ? -1.0 : 1.0});
  });
  return arms;
}

}  // namespace gonogo::vehicle
