// Velocities of bodies and motors in an iteration.
#pragma once
#include "sim/solver/incidence.h"

namespace gonogo::sim {

/// Motors turn bodies whose axle stays along world y.
GONOGO_HD inline Vec3 motor_axis() { return {0, 1, 0}; }

/// v_free + M^-1 (impulse and moment on the body) [m/s, rad/s].
GONOGO_HD_INLINED Velocity driven_velocity(const Velocity& free, const BodyMass& m, const SymMat3& inverse_inertia_W,
                                           const Vec3& linear, const Vec3& angular) {
  Velocity v;
  v.linear = free.linear + scale(m.inverse_mass, linear);
  v.angular = free.angular + (m.isotropic ? angular * m.inverse_inertia_B.x : inverse_inertia_W * angular);
  return v;
}

/// One projected-gradient update of a motor that holds a speed with limited torque. It has half of its body's inertia
/// to itself; see SplitMasses.
struct UpdateMotor {
  View<const Motor> motor;
  View<const Velocity> velocity;  // extrapolated
  View<const BodyMass> mass;
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Real> now, before;  // impulses [N m s]
  Real step;

  GONOGO_HD void operator()(Index i) const {
    const Motor& m = motor[i];
    const Momentum& iteration = momentum[world_of_body[m.body]];
    if (iteration.done) return;
    const Real limit = m.max_torque * step;
    const Real excess = dot(velocity[m.body].angular, motor_axis()) - m.speed;
    const Real from = now[i] + iteration.beta * (now[i] - before[i]);
    const Real wish = from - excess / (2 * mass[m.body].inverse_inertia_B.y);
    before[i] = now[i];
    now[i] = std::fmin(limit, std::fmax(-limit, wish));
  }
};

/// Energy of a body and gravity's power on it; velocities are those of the end of the step.
GONOGO_HD inline WorldSums energy_of_body(const BodyMass& m, const Quat& orientation, const Velocity& velocity,
                                          const Vec3& g) {
  const auto over = [](Real x, Real inverse) { return inverse > 0 ? double(x) / inverse : 0; };
  const Vec3& v = velocity.linear;
  const Vec3 w = rotate_back(orientation, velocity.angular);
  WorldSums s;
  s.kinetic = 0.5 * (over(v.x * v.x, m.inverse_mass.x) + over(v.y * v.y, m.inverse_mass.y) +
                     over(v.z * v.z, m.inverse_mass.z) + over(w.x * w.x, m.inverse_inertia_B.x) +
                     over(w.y * w.y, m.inverse_inertia_B.y) + over(w.z * w.z, m.inverse_inertia_B.z));
  s.gravity_power =
      over(g.x * v.x, m.inverse_mass.x) + over(g.y * v.y, m.inverse_mass.y) + over(g.z * v.z, m.inverse_mass.z);
  return s;
}

}  // namespace gonogo::sim
