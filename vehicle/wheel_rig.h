// A quarter vehicle: one driven, lugged wheel that carries a hub and a sprung mass. Along the slope and across it moves
// the whole quarter, along the bed's normal only the hub; the sprung mass rides on a spring and damper. Roll and yaw
// are held by the rest of the vehicle.
#pragma once
#include <filesystem>
#include <string>

#include "base/json/config.h"
#include "sim/simulation/simulation.h"

namespace gonogo::vehicle {

struct WheelRig {
  std::string name;
  double radius, width;  // without lugs [m]
  int lug_count;
  double lug_height, lug_thickness;  // [m]
  double axle_moment;                // of wheel and tyre about the axle [kg m^2]
  double hub_mass, sprung_mass;      // per wheel, without payload [kg]
  int wheels_per_vehicle;            // that share a payload
  double spring_stiffness;           // [N/m]
  double spring_damping;             // [N s/m]
  double max_torque;                 // at the wheel [N m]
  double vehicle_length;             // [m]
  double ground_clearance;           // under the hub at no sinkage [m]
};

/// Reads and checks a quarter-vehicle file; see configs/vehicles/hmmwv_quarter.json.
WheelRig read_wheel_rig(const std::filesystem::path& path);

/// Indices of the rig's parts in its world.
struct RigBodies {
  sim::BodyIndex wheel, sprung;
  Index motor;
};

/// Adds the rig to a world with its axle at `axle` and the spring unloaded, so that it is lowered by its own weight.
/// `payload` is the whole vehicle's [kg]; `tool_material` is the tyre's material in the world.
RigBodies add_wheel_rig(sim::SceneWorld& world, const WheelRig& rig, const Vec3d& axle, double payload,
                        int tool_material);

/// Mass moved along the slope [kg].
double rig_mass(const WheelRig& rig, double payload);

}  // namespace gonogo::vehicle
