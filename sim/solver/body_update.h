// Velocities of bodies in an iteration.
#pragma once
#include "sim/solver/colour.h"

namespace gonogo::sim {

/// v_free + M^-1 (impulse and moment on the body) [m/s, rad/s].
GONOGO_HD_INLINED Velocity driven_velocity(const Velocity& free, const BodyMass& m, const SymMat3& inverse_inertia_W,
                                           const Vec3& linear, const Vec3& angular) {
  Velocity v;
  v.linear = free.linear + scale(m.inverse_mass, linear);
  v.angular = free.angular + (m.isotropic ? angular * m.inverse_inertia_B.x : inverse_inertia_W * angular);
  return v;
}

/// Applies changes of contact impulses at once to the bodies that a Gauss-Seidel sweep moves.
struct SweptBodies {
  Incidence incidence;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  View<Velocity> velocity;

  GONOGO_HD void move(BodyIndex b, const Vec3& arm, const Impulse& change, Real sign) const {
    if (!is_swept(b, mass[b], incidence)) return;
    const SymMat3 inertia = mass[b].isotropic ? SymMat3{} : inverse_inertia_W[b];
    velocity[b] = driven_velocity(velocity[b], mass[b], inertia, change.linear * sign, moment(arm, change) * sign);
  }
};

/// Starts a body: returns and stores its velocity without impulses in the first substep. `change`: by gravity, spin and
/// forces in a substep.
GONOGO_HD_INLINED Velocity begin_body(const Velocity& v, const Velocity& change, Velocity& free, Velocity& earlier) {
  earlier.linear = earlier.angular = {};
  return free = sum(v, change);
}

/// Carries a body, which has moved with `v` through a substep, into the next one. `free` becomes the velocity without
/// impulses there; `substep_velocity` keeps `v` for the gaps, `earlier` adds it for the path. Returns the change of
/// `free`.
GONOGO_HD_INLINED Velocity carry_body(const Velocity& v, const Velocity& change, Velocity& free,
                                      Velocity& substep_velocity, Velocity& earlier) {
  const Velocity next = sum(v, change), more = difference(next, free);
  earlier.linear += v.linear;
  earlier.angular += v.angular;
  substep_velocity = v;
  free = next;
  return more;
}

/// Energy of a body and gravity's power on it, at the velocity of the step's end.
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
