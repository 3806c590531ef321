// Poses of a rigid vehicle on the ground, with their contacts.
#pragma once
#include "vehicle/feasible/feasible.h"
#include "vehicle/multibody/vehicle_tree.h"

namespace gonogo::vehicle {

struct Contact {
  int station = 0;
  multibody::Vector3 point;                  // in the frame of the ground [m]
  multibody::Vector3 normal, along, across;  // unit vectors
};

struct Pose {
  double pitch = 0;           // nose up [rad]
  multibody::Vector3 origin;  // of the vehicle in the frame of the ground [m]
  std::vector<Contact> contact;
  std::string climbing;  // axle at the step
  double rise = 0;       // of its wheels above the foot [m]
};

/// Pose on the plane.
Pose level_pose(const Vehicle& v);

/// Poses of each axle climbing a step, from foot to top.
std::vector<Pose> step_poses(const Vehicle& v, double step);

/// The vehicle with its suspension locked. Its wheels still turn.
Assembly locked(const Vehicle& v);

}  // namespace gonogo::vehicle
