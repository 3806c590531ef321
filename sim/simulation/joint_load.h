// Loads of joints and springs in the latest step.
#pragma once
#include "base/vec.h"

namespace gonogo::sim {

/// Force and moment of a joint, spring or damper on body a at a's point, and oppositely on b; world frame.
struct JointLoad {
  Vec3d force;   // [N]
  Vec3d moment;  // [N m]
};

}  // namespace gonogo::sim
