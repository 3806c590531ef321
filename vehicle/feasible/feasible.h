// Can a vehicle stand or creep on this ground? Inverse dynamics of the rigid vehicle, its suspension locked in the
// design position. Contact forces lie in friction cones; torques lie within the limits of driveline and brakes.
// The question is a convex cone program with an exact answer. "No" is a proof for hard ground. "Yes" is an upper bound:
// soft ground and dynamics can only make it worse.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/units.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

struct Demand {
  Vec3d gravity{0, 0, -kGravity};  // in the frame of the ground: x forward, y left, z out of it [m/s^2]
  double friction = 0.8;           // of every contact
  double step = 0;                 // height of a step that all axles must climb [m]
  double acceleration = 0;         // along x [m/s^2]
  double edge_distance = 0;  // least, of the centre of pressure from the edge of the wheels' polygon; on a plane [m]
  bool moving = true;        // wheels roll, driven or braked; false: parked, brakes only
};

/// Limits to apply. Leaving one out shows whether it binds.
struct Limits {
  bool friction = true, torque = true;
};

struct ContactForce {
  std::string wheel;
  double normal = 0, along = 0, across = 0;  // [N]
};

/// Where the contact forces press on a plane: the centre of pressure of the normal forces, which is the zero-moment
/// point (Vukobratovic & Borovac 2004).
struct Pressure {
  double x = 0, y = 0;  // [m]
  double edge = 0;      // distance inside the nearest edge of the contacts' convex hull; negative: beyond that edge [m]
};

struct Feasibility {
  bool feasible = false;
  /// Amount by which every normal load could fall before a friction cone or torque limit fails, as a share of the mean
  /// load. Negative: the amount that is missing.
  double reserve = 0;
  double pitch = 0, rise = 0;         // hardest pose on a step: pitch, nose up [rad]; rise of the climbing axle [m]
  std::string climbing;               // axle at the step; empty on a plane
  std::vector<ContactForce> contact;  // a solution; when infeasible, the nearest to one
  /// Pressure of these forces in the vehicle's frame; on a plane, with an area under the wheels.
  std::optional<Pressure> pressure;
  std::vector<double> torque;     // of each drive unit: a wheel, or the left and right sprocket [N m]
  std::vector<std::string> unit;  // their names
};

/// Throws InputError for a step when the vehicle does not have two axles, and for numbers out of range.
Feasibility feasible(const Vehicle& v, const Demand& demand, const Limits& limits = {});

/// Cause of infeasibility: "traction", "torque", "tip-over" (no normal forces balance the weight), "belly" (the chassis
/// hits the step), "centre of pressure" (too near the edge of the wheels' polygon), "traction or torque" (more of
/// either would do), "traction and torque" (more of both is needed). Empty when feasible.
std::string limiting_cause(const Vehicle& v, const Demand& demand);

/// Smallest friction coefficient at which the demand is feasible; infinity when there is none.
double min_friction(const Vehicle& v, Demand demand);

/// Smallest share of the torque limits that suffices; infinity when no torque does.
double min_torque_share(const Vehicle& v, const Demand& demand);

/// Belly clearance between the axles that a step needs [m].
double needed_clearance(const Vehicle& v, double step);

}  // namespace gonogo::vehicle
