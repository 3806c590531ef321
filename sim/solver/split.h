// Step sizes of the iterations on the cone complementarity problem
//     min 1/2 g' N g + r' g,  g in the product of contact cones,  N = D' M^-1 D + E        (Anitescu & Tasora 2010)
// by mass splitting (Tonge, Benevolenski, Voroshilov 2012). Each body shares its mass among its contacts:
//     S_c^-1 = d_a A_a + d_b A_b + E
// with 1 / d the contact's share of a body and A a bound on the body's part of the contact's inverse mass. Then
// S^-1 >= N as quadratic forms, so g - S grad never overshoots and needs no line search. A heavy wheel on light grains
// adds little to S^-1, although it has hundreds of contacts, and so does not slow the iteration.
//
// Colours for Gauss-Seidel: contacts of one colour share no body whose velocity the sweep changes, so they are updated
// at once. A wheel with hundreds of contacts would need hundreds of colours. Such bodies, and those of mechanisms, keep
// their velocity through a sweep and split their mass instead, which never overshoots either. Colours follow
// the greedy rule in the order of a hash (Jones & Plassmann 1993). Each contact waits for its neighbours that come
// before it, so any number of threads finds the same colours.
#pragma once
#include "sim/state/contact_lists.h"

namespace gonogo::sim {

/// Bodies with more contacts are not swept. A contact of two swept bodies has at most 62 neighbours, so 64 colours
/// suffice.
inline constexpr Index kMaxSweptContacts = 32;
inline constexpr Index kNoColour = -1;

/// Whether a sweep changes the body's velocity contact by contact.
GONOGO_HD inline bool is_swept(BodyIndex b, const BodyMass& mass, const Incidence& incidence) {
  if (is_fixed(mass) || mass.slot >= 0) return false;
  const Index owned = incidence.owned_end(b) - incidence.owned_begin(b);
  GONOGO_ASSERT(owned >= 0 && incidence.first_second[b] <= incidence.first_second[b + 1]);
  return owned + incidence.first_second[b + 1] - incidence.first_second[b] <= kMaxSweptContacts;
}

/// A permutation of the integers below 2^32: the finaliser of MurmurHash3 (public domain).
GONOGO_HD inline std::uint32_t shuffled(std::uint32_t i) {
  i = (i ^ (i >> 16)) * 0x85ebca6bu;
  i = (i ^ (i >> 13)) * 0xc2b2ae35u;
  return i ^ (i >> 16);
}

struct Colouring {
  Incidence incidence;
  View<const BodyMass> mass;
  View<const WorldParameters> world;
  View<const Contact> contact;
  View<Index> colour;  // [contact]

  /// Colours the contact if all neighbours before it have colours. Returns whether it has one now. Many threads may
  /// call this at once.
  GONOGO_HD bool try_colour(ContactIndex i) const {
    if (load_relaxed(colour[i]) != kNoColour) return true;
    const Contact& c = contact[i];
    const ContactIndex first = incidence.first_contact[world[c.world].first_shape];
    std::uint64_t taken = 0;
    if (!mark_before(i, first, c.body_a, taken) || !mark_before(i, first, c.body_b, taken)) return false;
    Index free = 0;
    while (taken >> free & 1) ++free;
    GONOGO_ASSERT(free < 2 * kMaxSweptContacts - 1);
    store_relaxed(colour[i], free);
    return true;
  }

 private:
  /// Marks the colours of a body's contacts that come before `i`; false if one has none yet.
  GONOGO_HD bool mark_before(ContactIndex i, ContactIndex first, BodyIndex b, std::uint64_t& taken) const {
    if (!is_swept(b, mass[b], incidence)) return true;
    for (ContactIndex k = incidence.owned_begin(b); k < incidence.owned_end(b); ++k)
      if (!mark(i, k, first, taken)) return false;
    for (Index k = incidence.first_second[b]; k < incidence.first_second[b + 1]; ++k)
      if (!mark(i, incidence.second[k], first, taken)) return false;
    return true;
  }

  GONOGO_HD bool mark(ContactIndex i, ContactIndex other, ContactIndex first, std::uint64_t& taken) const {
    if (shuffled(std::uint32_t(other - first)) >= shuffled(std::uint32_t(i - first))) return true;
    const Index its = load_relaxed(colour[other]);
    if (its == kNoColour) return false;
    GONOGO_ASSERT(its >= 0 && its < 64);
    taken |= std::uint64_t(1) << its;
    return true;
  }
};

template <class Exec>
Colouring colouring(State<Exec>& s, View<Index> colour) {
  return {incidence(s), s.mass.view(), s.world.view(), s.contact.view(), colour};
}

/// Share s of rolling and spinning in the bound of inverse_mass_bound.
inline constexpr Real kTurningShare = 0.5f;

/// Step sizes over the safe ones S, where a step has substeps of few updates; it lowers the residual of a driven wheel
/// by an eighth. Gradient steps converge below 2, with Nesterov's momentum below 4/3: while the stretched eigenvalue a
/// is below 4/3, the roots of z^2 - (1 + beta)(1 - a) z + beta (1 - a) stay inside the unit circle for every beta < 1.
/// With the high momentum of many updates 1.3 is too close to it: beta = 0.95 leaves z = -0.9, and the wheels of a
/// vehicle at rest would stay 1 % off their loads.
inline constexpr Real kStretch = 1.3f;

/// Bound on how far a unit impulse at the end of an arm moves that end by turning the body: the largest eigenvalue of
/// [r]' J^-1 [r] [1/kg]. Its trace is the better bound for a body that turns easily only about its arm, such as a
/// slender rod touched at its tip.
GONOGO_HD inline Real turning_bound(const Vec3& arm, const BodyMass& mass, const Quat& orientation) {
  const Vec3& i = mass.inverse_inertia_B;
  const Real largest = std::fmax(i.x, std::fmax(i.y, i.z)) * dot(arm, arm);
  if (mass.isotropic) return largest;
  const Vec3 r = rotate_back(orientation, arm), square = scale(r, r);
  return std::fmin(largest, i.x * (square.y + square.z) + i.y * (square.x + square.z) + i.z * (square.x + square.y));
}

/// Effective inverse masses of one body at a contact: bounds on the diagonal blocks of D' M^-1 D [1/kg, 1/kg, 1/(kg
/// m^2)].
GONOGO_HD inline ConeStep inverse_mass_bound(const Vec3& arm, const Vec3& normal, const BodyMass& mass,
                                             const Quat& orientation, bool turning) {
  GONOGO_ASSERT(is_unit(normal) && is_unit(orientation));
  const Vec3 normal_share = scale(mass.inverse_mass, scale(normal, normal));
  const Real linear = std::fmax(mass.inverse_mass.x, std::fmax(mass.inverse_mass.y, mass.inverse_mass.z));
  const Vec3& i = mass.inverse_inertia_B;
  const Vec3 off_centre = cross(arm, normal);
  // Not for a body that can only turn: its bound must stay above zero.
  const bool central = linear > 0 && dot(off_centre, off_centre) < Real(1e-6) * dot(arm, arm);
  // Normal and friction share one angular velocity when the arm is not along the normal; rolling always shares it.
  // (x + y)^2 <= (1 + s) x^2 + (1 + 1/s) y^2, with a small s because sliding matters more.
  const bool isotropic = mass.inverse_mass.x == mass.inverse_mass.y && mass.inverse_mass.y == mass.inverse_mass.z;
  const Real spin = (turning ? 1 + kTurningShare : Real(1)) * turning_bound(arm, mass, orientation);
  const Real n = isotropic ? normal_share.x + normal_share.y + normal_share.z : linear;
  return {n + (central ? Real(0) : spin), linear + spin,
          (turning ? 1 + 1 / kTurningShare : Real(1)) * std::fmax(i.x, std::fmax(i.y, i.z))};
}

/// The gap's bias, plus De Saxce's term for the `coulomb` target [m/s].
GONOGO_HD_INLINED Real target_bias(const Contact& c, const Velocity& a, const Velocity& b, Target target) {
  return target == Target::coulomb ? c.gap_bias + opening_speed<true, Real>(c, a, b) : c.gap_bias;
}

struct SplitMasses {
  View<const BodyMass> mass;
  View<const MechanismBody> jointed;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<const Index> weight;  // [body] sum over its contacts
  View<const Impulse> impulse;
  View<Contact> contact;
  Incidence incidence;
  Target target;
  bool sweeps;   // Gauss-Seidel: a contact gets the whole mass of a swept body
  Real stretch;  // kStretch or 1

  /// Number of shares over the contact's own. The motors of a mechanism get half of its bodies' masses.
  GONOGO_HD Real share(BodyIndex b, Real own) const {
    if (sweeps && is_swept(b, mass[b], incidence)) return 1;
    GONOGO_ASSERT(own >= 1 && (is_fixed(mass[b]) || Real(weight[b]) >= own));
    const bool driven = mass[b].slot >= 0 && jointed[mass[b].slot].driven != 0;
    return Real(weight[b]) * (driven ? Real(2) : Real(1)) / own;
  }

  GONOGO_HD void operator()(ContactIndex i) const { split(contact[i], impulse[i]); }

  /// `start`: the contact's warm start.
  GONOGO_HD_INLINED void split(Contact& c, const Impulse& start) const {
    const bool turning = c.rho > 0 || c.sigma > 0;
    const ConeStep a = inverse_mass_bound(c.arm_a, c.normal, mass[c.body_a], orientation[c.body_a], turning);
    const ConeStep b = inverse_mass_bound(c.arm_b, c.normal, mass[c.body_b], orientation[c.body_b], turning);
    const auto own = Real(contact_weight(c, start));
    const Real share_a = share(c.body_a, own), share_b = share(c.body_b, own);
    c.step.n = stretch / (share_a * a.n + share_b * b.n + c.softness);
    c.step.t = stretch / (share_a * a.t + share_b * b.t);
    c.step.r = turning ? stretch / (share_a * a.r + share_b * b.r) : Real(1);
    c.unsplit = (share_a * a.n + share_b * b.n) / (stretch * (a.n + b.n));
    GONOGO_ASSERT(!(c.step.n <= 0) && !(c.step.t <= 0) && !(c.step.r <= 0) && !(c.unsplit <= 0));
    c.bias = target_bias(c, velocity[c.body_a], velocity[c.body_b], target);
  }
};

/// A gap after the bodies have moved with these velocities through a substep, with the normal and arms of the step.
template <class T>
GONOGO_HD_INLINED T advanced_gap(const T& gap, const ContactNumbers<T>& c, const VelocityT<T>& a, const VelocityT<T>& b,
                                 Real substep) {
  return gap + substep * dot(c.normal, contact_velocity(c, a, b));
}

/// The same for the contact itself, and the bias that follows. `impulse`: the linear part of its present impulse.
GONOGO_HD_INLINED void advance_gap(Contact& c, const Velocity& a, const Velocity& b, const Vec3& impulse,
                                   const StepSettings& settings) {
  const Real gap = advanced_gap<Real>(c.gap, c, a, b, settings.substep());
  c.gap = counted_gap(gap, c.gap_rate, c.softness * dot(impulse, c.normal), settings);
  c.bias = c.gap_bias = bias_of_gap(c.gap, c.gap_rate, c.softness, settings);
}

/// Scaled natural map of a contact [m/s]: the change by one more projected-gradient step without mass splitting,
/// divided by that step, so that light grains count as much as wheels. It is zero exactly at the solution of the
/// target's law; `coulomb` uses the sliding speed at the end of the step.
GONOGO_HD_INLINED Real contact_residual(const Contact& c, const Velocity& a, const Velocity& b, const Impulse& from,
                                        Target target) {
  ContactNumbers<Real> numbers = c;
  numbers.bias = target_bias(c, a, b, target);
  const ConeStep step{c.step.n * c.unsplit, c.step.t * c.unsplit, c.step.r * c.unsplit};
  const Impulse next = projected_step<true, Real>(numbers, from, contact_gradient<Real>(numbers, a, b, from), step);
  return std::sqrt(residual_square<true, Real>(numbers, next, from, step));
}

template <class Exec>
SplitMasses mass_splitting(State<Exec>& s, const StepSettings& settings) {
  const bool stretched =
      settings.substeps > 1 && settings.iteration != Iteration::gauss_seidel && settings.iteration != Iteration::bb;
  return {.mass = s.mass.view(),
          .jointed = s.mechanisms.body.view(),
          .orientation = s.orientation.view(),
          .velocity = s.velocity.view(),
          .weight = s.contact_weight.view(),
          .impulse = s.store[s.parity].impulse.view(),
          .contact = s.contact.view(),
          .incidence = incidence(s),
          .target = settings.target,
          .sweeps = settings.iteration == Iteration::gauss_seidel,
          .stretch = stretched ? kStretch : Real(1)};
}

}  // namespace gonogo::sim
