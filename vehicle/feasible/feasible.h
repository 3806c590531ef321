// Can a vehicle stand or creep here at best? Inverse dynamics of the rigid vehicle in the design position of its
// suspension, with contact forces inside friction cones and torques inside the limits of driveline and brakes. The
// question is a convex cone program, answered exactly: "no" is a proof for hard ground, "yes" a bound that soft ground
// and dynamics only lower.
#pragma once
#include <string>
#include <vector>

#include "base/units.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

struct Demand {
  Vec3d gravity{0, 0, -kGravity};  // in the frame of the ground: x forward, y left, z out of it [m/s^2]
  double friction = 0.8;           // of every contact
  double step = 0;                 // height of a step that all axles must climb [m]
  double acceleration = 0;         // along x [m/s^2]
  bool moving = true;              // driven or braked by rolling wheels; false: parked, with brakes only
};

/// Limits that an answer may leave out, to find which one binds.
struct Limits {
  bool friction = true, torque = true;
};

struct ContactForce {
  std::string wheel;
  double normal = 0, along = 0, across = 0;  // [N]
};

struct Feasibility {
  bool feasible = false;
  /// How much every normal load could be lowered with the friction cones and torque limits still holding, as a share of
  /// the mean load; below zero: what is missing.
  double reserve = 0;
  double pitch = 0, rise = 0;         // of the hardest pose on a step: nose up [rad], of the climbing axle [m]
  std::string climbing;               // axle at the step, empty on a plane
  std::vector<ContactForce> contact;  // that stand or move it; of the nearest miss when infeasible
  std::vector<double> torque;         // of the drive units: wheels, or sprockets left and right [N m]
  std::vector<std::string> unit;      // their names
};

/// Throws InputError for a step under a vehicle that is not on two axles, and for numbers out of range.
Feasibility feasible(const Vehicle& v, const Demand& demand, const Limits& limits = {});

/// Why not: "traction", "torque", "tip-over" (no normal forces balance the weight), "belly" (the chassis meets the
/// step), or "traction and torque" (each is in the way of the other); empty when feasible.
std::string limiting_cause(const Vehicle& v, const Demand& demand);

/// Least friction coefficient that makes it feasible; infinite when none does.
double least_friction(const Vehicle& v, Demand demand);

/// Least share of the torque limits that suffices; infinite when no torque does.
double least_torque_share(const Vehicle& v, const Demand& demand);

/// Clearance under the belly that a step needs between the axles [m].
double needed_clearance(const Vehicle& v, double step);

}  // namespace gonogo::vehicle
