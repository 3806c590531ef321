// Who drives a vehicle in a world: a driver by the clock, with driveline, brakes and straight-line steering, or someone
// who sets throttle, brake and steering between steps.
#pragma once
#include <string>

#include "vehicle/world/engine_vehicle.h"

namespace gonogo::vehicle {

/// Orders to the driver, in the world's time.
struct DriverOrders {
  double release = 0;        // time at which the brakes are released [s]
  double throttle_ramp = 0;  // time in which throttle or commanded speed rises from zero [s]
  double speed = 0;          // speedometer reading to hold [m/s]; 0: full throttle
  double brake_from = 1e9;   // time of full braking with the throttle closed [s]
  int gear = 0;              // gear to stay in, 1 the lowest; 0: automatic shifts from the lowest
  bool by_hand = false;      // pedals stand at zero until someone sets them; brakes are left to whoever drives
};

/// Adds drivelines or controllers, brakes and differentials. Throws InputError for drivelines that the engine does not
/// know: a converter without capacity, a locking centre differential between axles with open ones.
void add_driveline(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const DriverOrders& orders);

/// Whether the file describes straight-line steering: gains of the driver, and steered wheels.
bool steers(const Vehicle& v);

/// Adds a controller that steers towards the line along x through the start, by a point ahead of the vehicle. The tie
/// rods' inner ends are held by arms that turn in the chassis. Each is parallel to its wheel's steering arm, so that
/// wheel and arm turn by the same angle. Call after add_vehicle(), if steers().
void add_steering(sim::SceneWorld& world, const Vehicle& v, EngineVehicle& e, const Vec3d& origin);

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
  double side = 1;  // 1 left, -1 right, 0 in the middle; of an arm: -1 behind the middle of the vehicle, where wheels
                    // turn the other way
  double max = 1;   // at full command [N m], [rad] or [-]
};

struct DrivenVehicle {
  EngineVehicle parts;
  SteeringKind steering = SteeringKind::none;
  Index driveline = -1;          // -1: wheel motors
  std::vector<Control> motor{};  // controllers of wheel motors
  std::vector<Control> arm{};    // controllers of steering arms
  std::vector<Control> brake{};  // motors
};

/// Like add_vehicle(), at rest with its pedals released. `v` must outlive the result. Throws InputError as
/// add_driveline().
DrivenVehicle add_driven_vehicle(sim::SceneWorld& world, const Vehicle& v, const Vec3d& origin, int tool_material);

/// Holds throttle and steering, both -1 to 1, from now on. Throttle below zero brakes, or with wheel motors drives
/// backwards. Steering above zero turns to the left. Throws InputError outside these ranges.
void set_controls(sim::Simulation& simulation, sim::WorldIndex world, const DrivenVehicle& v, double throttle,
                  double steering);

}  // namespace gonogo::vehicle
