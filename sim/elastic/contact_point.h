// What the Gauss points of a contact say about it.
#pragma once
#include "base/vec.h"

namespace gonogo::sim::elastic {

enum class Touch { open, stick, slip };  // stick: slower than epsilon

struct ContactPoint {
  int contact = 0;  // of the model
  Touch touch = Touch::open;
  Vec3d place{};   // of the displaced surface [m]
  Vec3d normal{};  // out of the obstacle or of the other body
  double gap = 0;  // [m]; open points of two bodies without a face opposite: infinity
  double area =
      0;  // that the point stands for, of the undeformed surface; in 2-D times the thickness or the turn [m^2]
  double pressure = 0;  // [Pa]
  Vec3d shear{};        // friction on `body` [Pa]
  Vec3d sliding{};      // tangential velocity of `body` over the other [m/s]
};

}  // namespace gonogo::sim::elastic
