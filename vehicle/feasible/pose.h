// Where a rigid vehicle touches the ground.
#pragma once
#include "vehicle/feasible/feasible.h"
#include "vehicle/multibody/vehicle_tree.h"

namespace gonogo::vehicle {

struct Contact {
  int station = 0;
  multibody::Vector3 point, normal, along, across;  // in the frame of the ground [m]; unit vectors
};

struct Pose {
  double pitch = 0;           // nose up [rad]
  multibody::Vector3 origin;  // of the vehicle in the frame of the ground [m]
  std::vector<Contact> contact;
  std::string climbing;  // axle
  double rise = 0;       // of its wheels [m]
};

/// On the plane.
Pose level_pose(const Vehicle& v);

/// Both axles climbing a step from its foot to its top.
std::vector<Pose> step_poses(const Vehicle& v, double step);

/// The vehicle with its suspension locked: chassis and wheels that turn.
Assembly locked(const Vehicle& v);

}  // namespace gonogo::vehicle
