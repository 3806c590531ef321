// Forces of a contact by the penalty family: a spring and damper along the normal, a spring with history and damper
// along the tangent that slips by Coulomb's law, and the same about the axes for rolling and spinning.
//   spring_damper  Cundall & Strack (1979), tangential stiffness a share of the normal one
//   hertz          Hertz along the normal; Mindlin's k_t = 8 G* a along the tangent, as increments of the force, which
//                  shrinks with k_t while the contact unloads (Thornton, Cummins & Cleary 2013)
// Without adhesion the force never pulls.
#pragma once
#include "base/units.h"
#include "sim/state/world.h"

namespace gonogo::sim {

/// One contact. Vectors are in the world frame; what is relative is a's minus b's.
struct PenaltyContact {
  Vec3 normal;              // unit, from b to a
  Real gap = 0;             // negative: overlap [m]
  Vec3 velocity, turn;      // relative, at the contact point [m/s]; relative spin [rad/s]
  Real mean_spin = 0;       // mean of both spins along the normal [rad/s]
  Real mass = 0;            // effective, along the normal [kg]
  Real radius = 0;          // effective [m]
  Real mu = 0;              // [-]
  Real rho = 0, sigma = 0;  // rolling and spinning resistance: coefficient times radius [m]
  Real cohesion = 0;        // constant pull of the PairLaw [N]; 0 out of its range
  Real stiffness = 0;       // of a compliant PairLaw [N/m], or 0
  Real damping = 0;         // of a compliant PairLaw [N s/m]
};

/// On a; b gets the opposite force at the same point and the opposite moment.
struct PenaltyForce {
  Vec3 force;   // [N]
  Vec3 moment;  // [N m]
};

/// The elastic part along the normal.
struct NormalSpring {
  Real push = 0, pull = 0;  // repulsion and attraction [N]
  Real stiffness = 0;       // dF/d(overlap) of the repulsion [N/m]
  Real tangential = 0;      // stiffness of the tangential spring [N/m]; 0: no contact
  Real holding = 0;         // pull-off force by which the load that friction feels exceeds push - pull [N]
};

/// Radius of the contact circle by Johnson, Kendall & Roberts (1971):  a^2 / R - sqrt(2 pi w a / E*) = overlap.
/// The left side is convex, so Newton's method climbs down from above it without passing the root [m].
GONOGO_HD inline Real jkr_radius(Real overlap, Real radius, Real modulus, Real work) {
  const Real root = std::sqrt(2 * Real(kPi) * work / modulus);
  const Real at_zero = std::cbrt(root * root * radius * radius);
  Real a = at_zero + std::sqrt(radius * std::fmax(overlap, Real(0)));
  for (int k = 0; k < 8; ++k) {
    const Real s = std::sqrt(a);
    const Real slope = 2 * a / radius - root / (2 * s);
    if (!(slope > 0)) return a;
    a -= (a * a / radius - root * s - overlap) / slope;
  }
  return a;
}

/// Overlap, below zero, at which a JKR contact that is drawn apart breaks: 3 a^2 / R at a^(3/2) = R / 4 sqrt(2 pi w /
/// E*) [m].
GONOGO_HD inline Real jkr_break(Real radius, Real modulus, Real work) {
  const Real root = std::sqrt(2 * Real(kPi) * work / modulus);
  const Real a = std::cbrt(root * root * radius * radius / 16);
  return -3 * a * a / radius;
}

GONOGO_HD inline NormalSpring linear_spring(Real overlap, Real stiffness, Real tangential_share) {
  if (!(overlap > 0)) return {};
  return {stiffness * overlap, 0, stiffness, tangential_share * stiffness, 0};
}

/// `touched`: in the step before.
GONOGO_HD inline NormalSpring hertz_spring(Real overlap, Real radius, const PenaltyLaw& law, bool touched) {
  const bool jkr = law.work_of_adhesion > 0 && law.adhesion == Adhesion::jkr;
  const Real least = jkr && touched ? jkr_break(radius, law.modulus, law.work_of_adhesion) : Real(0);
  if (!(overlap > least)) return {};
  const Real a = jkr ? jkr_radius(overlap, radius, law.modulus, law.work_of_adhesion) : std::sqrt(radius * overlap);
  NormalSpring s;
  s.push = Real(4) / 3 * law.modulus * a * a * a / radius;
  s.stiffness = 2 * law.modulus * a;
  s.tangential = 8 * law.shear_modulus * a;
  if (jkr) {
    s.pull = std::sqrt(8 * Real(kPi) * law.work_of_adhesion * law.modulus * a * a * a);
    s.holding = 3 * Real(kPi) * law.work_of_adhesion * radius;  // twice the pull-off force 3/2 pi w R (Thornton 1991)
  } else if (law.work_of_adhesion > 0) {
    s.pull = s.holding = 2 * Real(kPi) * law.work_of_adhesion * radius;
  }
  return s;
}

/// A tangential vector of the step before, turned with the contact: by the least rotation that takes the old normal to
/// the new one, then about the new one. A rigid rotation of both bodies keeps its length.
GONOGO_HD inline Vec3 turned_with_contact(const Vec3& v, const Vec3& from, const Vec3& to, Real angle) {
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

/// Damping coefficient of a spring; Hertz's by Tsuji, Tanaka & Ishida (1992) with the factor sqrt(5 / 6) of the
/// tangent stiffness, for which Antypov & Elliott (2011) map it onto the linear law [N s/m].
GONOGO_HD inline Real damping_of(Real ratio, Real mass, Real stiffness, bool hertz) {
  return (hertz ? Real(1.8257418583505538) : Real(2)) * ratio * std::sqrt(mass * stiffness);
}

/// Forces of a contact after the step that ends now, and what it remembers. `history`: in and out.
GONOGO_HD inline PenaltyForce penalty_force(const PenaltyContact& c, const PenaltyNumbers& numbers, bool hertz,
                                            Real step, ContactHistory& history) {
  const PenaltyLaw& law = numbers.law;
  const bool compliant = c.stiffness > 0, hertzian = hertz && !compliant;
  const NormalSpring s = hertzian
                             ? hertz_spring(-c.gap, c.radius, law, history.stiffness > 0)
                             : linear_spring(-c.gap, compliant ? c.stiffness : law.stiffness, law.tangential_share);
  if (!(s.tangential > 0) && !(s.push > 0)) {
    history = {};
    return {c.normal * -c.cohesion, {}};
  }
  const Real speed = dot(c.velocity, c.normal);
  const Real resistance = compliant ? c.damping : damping_of(numbers.damping_ratio, c.mass, s.stiffness, hertzian);
  const Real push = std::fmax(s.push - resistance * speed, Real(0));
  const Real pull = s.pull + c.cohesion;
  const Real load = std::fmax(push - s.pull + s.holding, Real(0));  // what friction feels

  const Real kept = history.stiffness > s.tangential ? s.tangential / history.stiffness : Real(1);
  const Real angle = c.mean_spin * step;
  const bool touched = history.stiffness > 0;
  const Vec3 from = touched ? history.normal : c.normal;
  const Real damping = damping_of(numbers.damping_ratio, c.mass, s.tangential, hertzian);

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
  history.stiffness = s.tangential;
  history.normal = c.normal;
  return f;
}

}  // namespace gonogo::sim
