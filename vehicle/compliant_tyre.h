// Compliance of a tyre on grains: every contact is a spring, and all that a static footprint has are the tyre.
#pragma once
#include <algorithm>
#include <cmath>

#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

/// Spring and damper of one contact between tyre and grain along its normal [N/m], [N s/m].
struct ContactSpring {
  double stiffness = 0, damping = 0;
};

/// A cylinder pressed by d into a foundation of c per area carries 4/3 c b d sqrt(2 r d). It is to carry its load W at
/// d = W / k, and a grain takes the square of its diameter of the area:
///   k_contact = 3/4 k D^2 / (b sqrt(2 r W / k))
/// Grains as wide as the footprint get the whole stiffness.
inline ContactSpring contact_spring(const Wheel& w, double load, double grain_diameter) {
  const double half = std::sqrt(2 * w.radius * load / w.stiffness);
  const double share = std::min(1.0, 0.75 * grain_diameter * grain_diameter / (w.width * half));
  return {share * w.stiffness, share * w.damping};
}

}  // namespace gonogo::vehicle
