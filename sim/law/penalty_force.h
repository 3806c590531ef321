// Forces of a contact by the penalty family: a spring and damper along the normal, a spring with history and damper
// along the tangent that slips by Coulomb's law, and the same about the axes for rolling and spinning. Without adhesion
// the force never pulls. The law gives the springs.
#pragma once
#include "sim/law/contact_law.h"

namespace gonogo::sim {

/// One contact. Vectors are in the world frame; what is relative is a's minus b's.
struct PenaltyContact {
  Vec3 normal;   // unit, from b to a
  Real gap = 0;  // negative: overlap [m]
  Vec3 velocity,
      turn;            // relative, at the contact point [m/s]; relative spin [rad/s]
  Real mean_spin = 0;  // mean of both spins along the normal [rad/s]
  Real mass = 0;       // effective, along the normal [kg]
  Real radius = 0;     // effective [m]
  Real mu = 0;         // [-]
  Real rho = 0,
       sigma = 0;      // rolling and spinning resistance: coefficient times radius [m]
  Real cohesion = 0;   // constant pull of the PairLaw [N]; 0 out of its range
  Real stiffness = 0;  // of a compliant PairLaw [N/m], or 0
  Real damping = 0;    // of a compliant PairLaw [N s/m]
};

/// On a; b gets the opposite force at the same point and the opposite moment.
struct PenaltyForce {
  Vec3 force;   // [N]
  Vec3 moment;  // [N m]
};

/// A tangential vector of the step before, turned with the contact: by the least rotation that takes the old normal to
/// the new one, then about the new one. A rigid rotation of both bodies keeps its length.
GONOGO_HD inline Vec3 turned_with_contact(const Vec3& v, const Vec3& from, const Vec3& to, Real angle) {
  GONOGO_ASSERT(is_unit(from) && is_unit(to));
  const Vec3 axis = cross(from, to);
  const Real c = dot(from, to);
  Vec3 w = c > Real(-0.5) ? v * c + cross(axis, v) + axis * (dot(axis, v) / (1 + c)) : v;
  // cos and sin of the angle by its half's tangent, to third order: the pair stays on the unit circle.
  const Real t = angle / 2, all = 1 / (1 + t * t);
  const Vec3 along = to * dot(to, w), across = w - along;
  w = along + across * ((1 - t * t) * all) + cross(to, across) * (2 * t * all);
  return w;
}

GONOGO_HD inline Vec3 clipped(const Vec3& v, Real limit) {
  GONOGO_ASSERT(!(limit < 0));
  const Real square = dot(v, v);
  return square > limit * limit ? v * (limit / std::sqrt(square)) : v;
}

/// A spring of force `before` that the rate `rate` stretches for a step, against slip beyond `limit`. Damping acts
/// while it holds. Returns the whole force; `spring` becomes the spring's.
GONOGO_HD inline Vec3 slip_spring(const Vec3& before, const Vec3& rate, Real stiffness, Real damping, Real limit,
                                  Real step, Vec3& spring) {
  const Vec3 trial = before - rate * (stiffness * step);
  spring = clipped(trial, limit);
  if (dot(trial, trial) > limit * limit) return spring;
  return clipped(trial - rate * damping, limit);
}

/// Damping coefficient of a spring [N s/m]; `factor`: kDamping of its law.
GONOGO_HD inline Real damping_of(Real factor, Real ratio, Real mass, Real stiffness) {
  return factor * ratio * std::sqrt(mass * stiffness);
}

/// Forces of a contact after the step that ends now, and what it remembers. `history`: in and out.
template <class Law>
GONOGO_HD inline PenaltyForce penalty_force(const PenaltyContact& c, const PenaltyNumbers& numbers, Real step,
                                            ContactHistory& history) {
  const PenaltyLaw& law = numbers.law;
  GONOGO_ASSERT(step > 0 && is_unit(c.normal));
  GONOGO_ASSERT(c.mass >= 0 && c.mu >= 0 && c.rho >= 0 && c.sigma >= 0 && c.cohesion >= 0);
  GONOGO_ASSERT(numbers.damping_ratio >= 0 && history.stiffness >= 0);
  const bool compliant = c.stiffness > 0;
  const NormalSpring s = compliant ? linear_spring(-c.gap, c.stiffness, law.tangential_share)
                                   : Law::spring(law, -c.gap, c.radius, history.stiffness > 0);
  if (!(s.tangential > 0) && !(s.push > 0)) {
    history = {};
    return {c.normal * -c.cohesion, {}};
  }
  const Real speed = dot(c.velocity, c.normal), factor = compliant ? SpringDamperLaw::kDamping : Law::kDamping;
  const Real resistance = compliant ? c.damping : damping_of(factor, numbers.damping_ratio, c.mass, s.stiffness);
  const Real push = std::fmax(s.push - resistance * speed, Real(0));
  const Real pull = s.pull + c.cohesion;
  const Real load = std::fmax(push - s.pull + s.holding, Real(0));  // what friction feels

  const Real kept = history.stiffness > s.tangential ? s.tangential / history.stiffness : Real(1);
  const Real angle = c.mean_spin * step;
  const bool touched = history.stiffness > 0;
  const Vec3 from = touched ? history.normal : c.normal;
  const Real damping = damping_of(factor, numbers.damping_ratio, c.mass, s.tangential);

  PenaltyForce f;
  Vec3 held = turned_with_contact(history.force, from, c.normal, angle) * kept;
  held -= c.normal * dot(held, c.normal);
  const Vec3 slip = c.velocity - c.normal * speed;
  f.force = slip_spring(held, slip, s.tangential, damping, c.mu * load, step, history.force);
  f.force += c.normal * (push - pull);
  if (c.rho > 0 || c.sigma > 0) {
    const Real square = c.radius * c.radius;
    const Vec3 moment = turned_with_contact(history.moment, from, c.normal, angle) * kept;
    const Vec3 spin_m = c.normal * dot(moment, c.normal), spin_w = c.normal * dot(c.turn, c.normal);
    Vec3 rolled, spun;
    f.moment = slip_spring(moment - spin_m, c.turn - spin_w, s.tangential * square, damping * square, c.rho * load,
                           step, rolled);
    f.moment += slip_spring(spin_m, spin_w, s.tangential * square, damping * square, c.sigma * load, step, spun);
    history.moment = rolled + spun;
  }
  GONOGO_ASSERT(!(dot(history.force, history.force) > Real(1.001) * c.mu * c.mu * load * load));
  history.stiffness = s.tangential;
  history.normal = c.normal;
  return f;
}

}  // namespace gonogo::sim
