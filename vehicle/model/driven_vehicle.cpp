#include "vehicle/model/driven_vehicle.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::vehicle {
namespace {

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

/// Controllers that add_drive() added, one for each driven wheel.
std::vector<Control> motors_of(const EngineVehicle& e, std::size_t first_controller) {
  std::vector<Control> motors;
  for (std::size_t i = 0; i < e.station.size(); ++i)
    if (e.drive_motor[i] >= 0) motors.push_back({Index(first_controller + motors.size()), e.station[i].side, 1});
  return motors;
}

}  // namespace

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
  const bool brakes = !v.track.empty() || std::any_of(stopped.begin(), stopped.end(), [](const Station& s) {
    return s.brake_torque > 0 && s.side != 0;
  });
  return brakes ? SteeringKind::brakes : SteeringKind::none;
}

DrivenVehicle add_driven_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material) {
  DrivenVehicle d;
  d.parts = add_vehicle(world, v, origin, tool_material);
  d.steering = steering_of(v);
  if (d.steering == SteeringKind::wheels)
    for (const SteeredArm& arm : add_hand_steering(world, v, d.parts, origin))
      d.arm.push_back({arm.controller, arm.side, v.max_steering_angle});
  const std::size_t controllers = world.controller.size();
  DriverOrders orders;
  orders.by_hand = true;
  add_drive(world, v, d.parts, orders);
  if (v.driveline.wheel_motors)
    d.motor = motors_of(d.parts, controllers);
  else
    d.driveline = Index(world.driveline.size()) - 1;
  d.brake = brakes_of(d.parts);
  return d;
}

void drive(sim::Simulation& simulation, sim::WorldIndex world, const DrivenVehicle& v, double throttle,
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
