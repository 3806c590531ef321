// A quarter vehicle: one driven, lugged wheel with a hub and a sprung mass on a spring and damper. The whole quarter
// moves along and across the slope. Along the bed's normal, hub and sprung mass move separately. The rest of the
// vehicle holds roll and yaw.
#pragma once
#include <filesystem>
#include <string>

#include "base/json/config.h"
#include "sim/simulation/simulation.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

struct WheelRig {
  std::string name;
  double radius, width;  // without lugs [m]
  int lug_count;
  double lug_height, lug_thickness;  // [m]
  double axle_moment;                // of wheel and tyre about the axle [kg m^2]
  double hub_mass, sprung_mass;      // per wheel, without payload [kg]
  int wheels_per_vehicle;            // that carry the payload together
  double spring_stiffness;           // [N/m]
  double spring_damping;             // [N s/m]
  double max_torque;                 // at the wheel [N m]
  double vehicle_length;             // [m]
  double ground_clearance;           // under the hub at zero sinkage [m]
  TyreSpring compliant;
};

/// Reads and checks a quarter-vehicle file, or the text of one; see configs/vehicles/hmmwv_quarter.json.
WheelRig read_wheel_rig(const std::filesystem::path& path);
WheelRig read_wheel_rig(const Config& c);

/// The rig in its world.
struct RigBodies {
  sim::BodyIndex wheel, sprung;
  Index motor;
};

/// Adds the rig with its axle at `axle` and its spring unloaded; it settles under its own weight. `payload` is the
/// whole vehicle's [kg]. `tool_material` is the tyre's material in the world. `yaw`: of the wheel's heading from x
/// towards y [rad].
RigBodies add_wheel_rig(sim::SceneWorld& world, const WheelRig& rig, const Vec3d& axle, double payload,
                        int tool_material, double yaw = 0);

/// Mass that moves along the slope [kg].
double rig_mass(const WheelRig& rig, double payload);

}  // namespace gonogo::vehicle
