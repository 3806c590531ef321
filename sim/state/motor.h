// Motors inside the iteration. A speed motor is a bilateral row with bounded impulse,
//     |p| <= h T,   p < h T => axis . (w_a - w_b) >= speed,   p > -h T => axis . (w_a - w_b) <= speed,
// and takes projected-gradient steps beside the contacts. A torque motor's impulse is h T from the start.
#pragma once
#include "sim/state/mechanism.h"
#include "sim/state/momentum.h"

namespace gonogo::sim {

/// The motor's axis in the world.
GONOGO_HD inline Vec3 motor_axis(const Motor& m, View<const Quat> orientation) {
  return m.b == kWorld ? m.axis_B : rotate(orientation[m.b], m.axis_B);
}

/// Speed of a relative to b about the motor's axis [rad/s].
GONOGO_HD inline Real motor_speed(const Motor& m, const Vec3& axis_W, View<const Velocity> velocity) {
  Vec3 w = velocity[m.a].angular;
  if (m.b != kWorld) w -= velocity[m.b].angular;
  return dot(w, axis_W);
}

/// Next impulse on a about the axis [N m s]; `impulse`, `speed`: extrapolated.
GONOGO_HD inline Real updated_motor(const Motor& m, const MotorDrive& drive, Real impulse, Real speed, Real step) {
  if (m.kind == MotorKind::torque) return m.target * step;
  const Real limit = m.max_torque * step;
  return std::fmin(limit, std::fmax(-limit, impulse - drive.step * (speed - m.target)));
}

/// One accelerated update of a motor.
struct UpdateMotor {
  View<const Motor> motor;
  View<const MotorDrive> drive;
  View<const Velocity> velocity;  // extrapolated
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Real> now, before;  // impulses [N m s]
  Real step;

  GONOGO_HD void operator()(Index i) const {
    const Momentum& iteration = momentum[world_of_body[motor[i].a]];
    if (!iteration.done) update(i, iteration.beta);
  }

  /// In a world that iterates with momentum `beta`.
  GONOGO_HD void update(Index i, Real beta) const {
    const Motor m = motor[i];
    const MotorDrive at = drive[i];
    const Real latest = now[i], from = multiply_add(beta, latest - before[i], latest);
    const Real speed = motor_speed(m, at.axis_W, velocity);
    before[i] = latest;
    now[i] = updated_motor(m, at, from, speed, step);
  }
};

/// Sum of the motors' impulses on a body of a mechanism [N m s].
struct MotorMoment {
  View<const MechanismBody> body;
  View<const Index> motor_entry;
  View<const MotorDrive> drive;
  View<const Real> impulse;

  GONOGO_HD Vec3 operator()(Index k) const {
    Vec3 sum;
    for (Index e = body[k].first_motor_entry; e < body[k].end_motor_entry; ++e) {
      const Index i = motor_entry[e] / 2;
      const Real p = motor_entry[e] % 2 == 0 ? impulse[i] : -impulse[i];
      sum += drive[i].axis_W * p;
    }
    return sum;
  }
};

template <class Exec>
MotorMoment motor_moment(MechanismStore<Exec>& s) {
  return {s.body.view(), s.motor_entry.view(), s.drive.view(), s.motor_impulse.view()};
}

}  // namespace gonogo::sim
