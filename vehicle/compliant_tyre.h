// Compliance of a tyre on grains. Every contact is a spring, such that the springs of a static footprint together have
// the stiffness of the tyre.
#pragma once
#include <algorithm>
#include <cmath>

#include "vehicle/model/vehicle.h"
#include "vehicle/wheel_rig.h"

namespace gonogo::vehicle {

/// One contact of tyre and grain, along its normal: stiffness [N/m], damping [N s/m].
struct ContactSpring {
  double stiffness = 0, damping = 0;
};

/// A cylinder of width b pressed by d into a foundation of stiffness c per area carries 4/3 c b d sqrt(2 r d). The load
/// W shall be carried at d = W / k, k the stiffness of the tyre. A grain of diameter D covers the area D^2, so that
///   k_contact = 3/4 k D^2 / (b sqrt(2 r W / k)),  at most k.
template <class AnyWheel>  // Wheel or WheelRig
ContactSpring contact_spring(const AnyWheel& w, double load, double grain_diameter) {
  const TyreSpring& tyre = w.compliant;
  const double half = std::sqrt(2 * w.radius * load / tyre.stiffness);
  const double share = std::min(1.0, 0.75 * grain_diameter * grain_diameter / (w.width * half));
  return {share * tyre.stiffness, share * tyre.damping};
}

}  // namespace gonogo::vehicle
