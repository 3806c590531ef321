// The one place that says how fast a motor turns.
#pragma once
#include "sim/world/state.h"

namespace gonogo::sim {

/// About the motor's axis, forward positive [rad/s].
GONOGO_HD inline Real motor_speed(const Motor& motor, View<const Velocity> velocity) {
  return velocity[motor.body].angular.y;
}

}  // namespace gonogo::sim
