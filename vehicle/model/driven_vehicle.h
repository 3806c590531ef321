// A whole vehicle that is driven from outside, step by step: throttle, brake and steering are set between steps.
#pragma once
#include "vehicle/model/engine_vehicle.h"

namespace gonogo::vehicle {

/// What turns a vehicle.
enum class SteeringKind {
  none,
  wheels,  // steered wheels; behind the middle of the vehicle they turn the other way
  motors,  // unequal torques of wheel motors on the two sides
  brakes   // the brakes of one side
};

std::string name_of(SteeringKind kind);

/// How this vehicle turns: by steered wheels if it has some, else by its wheel motors, else by its brakes.
SteeringKind steering_of(const Vehicle& v);

/// A motor or controller of a wheel, sprocket or steering arm.
struct Control {
  Index index = 0;
  double side = 1;  // 1 left, -1 right, 0 in the middle; of an arm: as SteeredArm's
  double max = 1;   // at full command [N m], [rad] or [-]
};

struct DrivenVehicle {
  EngineVehicle parts;
  SteeringKind steering = SteeringKind::none;
  Index driveline = -1;        // -1: wheel motors
  std::vector<Control> motor;  // controllers of wheel motors
  std::vector<Control> arm;    // controllers of steering arms
  std::vector<Control> brake;  // motors
};

/// As add_vehicle(), at rest with its pedals released. `v` must outlive the result. Throws InputError as add_drive().
DrivenVehicle add_driven_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material);

/// Holds throttle and steering, both -1 to 1, from now on. Throttle below zero brakes, or with wheel motors drives
/// backwards. Steering above zero turns to the left. Throws InputError outside these ranges.
void drive(sim::Simulation& simulation, sim::WorldIndex world, const DrivenVehicle& v, double throttle,
           double steering);

}  // namespace gonogo::vehicle
