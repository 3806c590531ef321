// The reduced-coordinate model of a vehicle.
#pragma once
#include "vehicle/model/assembly.h"
#include "vehicle/multibody/dynamics.h"

namespace gonogo::vehicle::multibody {

inline Vector3 vector(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// Body i of the assembly is body i of the tree. The chassis floats; every other body hangs on its link. In the design
/// position all frames are parallel to the vehicle's. A body's origin is the point of its link, the chassis's origin is
/// the vehicle's.
struct VehicleTree {
  Tree tree;
  std::vector<Loop> loop;
  std::vector<Vector3> origin;  // of the bodies' frames in the vehicle's [m]
  std::vector<int> axle;        // velocity index of each station's wheel
  /// A point of the vehicle's frame, in the frame of a body, in the design position.
  Vector3 local(int body, const Vec3d& point) const { return vector(point) - origin[std::size_t(body)]; }
};
VehicleTree vehicle_tree(const Assembly& assembly);

}  // namespace gonogo::vehicle::multibody
