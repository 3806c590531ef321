// Accelerated projected gradient descent on the cone complementarity problem
//     min 1/2 g' N g + r' g,  g in the product of contact cones,  N = D' M^-1 D        (Anitescu & Tasora 2010)
// with N never formed: the iteration lives on velocities v = v_free + M^-1 D g.
//
// Step sizes come from mass splitting (Tonge, Benevolenski, Voroshilov 2012): each body shares its mass equally among
// its contacts, S_c^-1 = d_a A_a + d_b A_b with d the number of contacts of a body and A a bound on its part of the
// contact's inverse mass. Then S^-1 >= N as quadratic forms, so g - S grad never overshoots and no line search is
// needed. A wheel a thousand times heavier than a grain adds little to S^-1 although it has hundreds of contacts: it
// slows nobody down. Momentum and its restart follow Nesterov 1983 and O'Donoghue & Candes 2015 (gradient scheme, eq.
// 13), per world.
#pragma once
#include "sim/solver/incidence.h"
#include "sim/solver/update_packed.h"

namespace gonogo::sim {

/// Effective inverse masses of one body at a contact: bounds on the diagonal blocks of D' M^-1 D [1/kg, 1/kg, 1/(kg
/// m^2)].
GONOGO_HD inline ConeStep inverse_mass_bound(const Vec3& arm, const Vec3& normal, const BodyMass& mass, bool rolling) {
  const Vec3 normal_share = scale(mass.inverse_mass, scale(normal, normal));
  const Real linear = std::fmax(mass.inverse_mass.x, std::fmax(mass.inverse_mass.y, mass.inverse_mass.z));
  const Vec3& i = mass.inverse_inertia_B;
  const Real angular = std::fmax(i.x, std::fmax(i.y, i.z));
  const Real arm_square = dot(arm, arm);
  const Vec3 off_centre = cross(arm, normal);
  // A body that can only turn keeps its spin even there: the bound of a contact must stay above zero.
  const bool central = linear > 0 && dot(off_centre, off_centre) < Real(1e-6) * arm_square;
  // Normal and friction share one angular velocity when the arm is not along the normal; rolling shares it always:
  // (x + y)^2 <= 2 x^2 + 2 y^2.
  const bool isotropic = mass.inverse_mass.x == mass.inverse_mass.y && mass.inverse_mass.y == mass.inverse_mass.z;
  const Real shared = rolling ? Real(2) : Real(1);
  const Real spin = shared * angular * arm_square;
  const Real n = isotropic ? normal_share.x + normal_share.y + normal_share.z : linear;
  return {n + (central ? Real(0) : spin), linear + spin, shared * angular};
}

struct PrepareContact {
  Incidence incidence;
  View<const BodyMass> mass;
  View<Contact> contact;
  View<const Impulse> impulse;
  View<Impulse> extrapolated;

  /// A motor takes half of its body's mass, the contacts share the rest.
  GONOGO_HD Real share(BodyIndex b) const {
    return Real(incidence.degree(b)) * (mass[b].motor >= 0 ? Real(2) : Real(1));
  }

  GONOGO_HD void operator()(Index i) const {
    Contact& c = contact[i];
    const ConeStep a = inverse_mass_bound(c.arm_a, c.normal, mass[c.body_a], c.rho > 0);
    const ConeStep b = inverse_mass_bound(c.arm_b, c.normal, mass[c.body_b], c.rho > 0);
    const Real share_a = share(c.body_a), share_b = share(c.body_b);
    c.step.n = 1 / (share_a * a.n + share_b * b.n);
    c.step.t = 1 / (share_a * a.t + share_b * b.t);
    c.step.r = c.rho > 0 ? 1 / (share_a * a.r + share_b * b.r) : Real(1);
    c.unsplit = (share_a * a.n + share_b * b.n) / (a.n + b.n);
    extrapolated[i] = impulse[i];
  }
};

/// Velocity of a body under its free motion and the given contact impulses.
struct GatherVelocity {
  Incidence incidence;
  View<const Contact> contact;
  View<const Impulse> impulse;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  View<const Real> motor_impulse;
  View<const Velocity> free_velocity;
  View<const Real> progress;
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Velocity> velocity;
  View<Real> body_progress;

  GONOGO_HD void operator()(BodyIndex b) const {
    if (momentum[world_of_body[b]].phase == Phase::done) return;
    Vec3 linear, angular;
    Real owned_progress = 0;
    for (Index i = incidence.owned_begin(b); i < incidence.owned_end(b); ++i) {
      const Impulse& p = impulse[i];
      linear += p.linear;
      angular += cross(contact[i].arm_a, p.linear) + p.angular;
      owned_progress += progress[i];
    }
    for (Index k = incidence.first_second[b]; k < incidence.first_second[b + 1]; ++k) {
      const Index i = incidence.second[k];
      const Impulse& p = impulse[i];
      linear -= p.linear;
      angular -= cross(contact[i].arm_b, p.linear) + p.angular;
    }
    const BodyMass& m = mass[b];
    if (m.motor >= 0) angular += rotation_axis(b) * motor_impulse[m.motor];
    const Velocity& from = free_velocity[b];
    velocity[b].linear = from.linear + scale(m.inverse_mass, linear);
    velocity[b].angular =
        from.angular + (m.isotropic ? angular * m.inverse_inertia_B.x : inverse_inertia_W[b] * angular);
    body_progress[b] = owned_progress;
  }

  /// Motors turn bodies whose axle stays along world y.
  GONOGO_HD Vec3 rotation_axis(BodyIndex) const { return {0, 1, 0}; }
};

/// One accelerated update of every contact.
struct UpdateContact {
  View<const Contact> contact;
  View<const Velocity> velocity;  // at the extrapolated impulses
  View<const Momentum> momentum;  // [world]
  View<Impulse> impulse, extrapolated;
  View<Real> progress, residual_square;

  GONOGO_HD void operator()(Index i) const {
    const Contact& c = contact[i];
    if (momentum[c.world].phase == Phase::done) return;
    const ContactUpdate<Real> u = accelerated_update<Real>(c, velocity[c.body_a], velocity[c.body_b], impulse[i],
                                                           extrapolated[i], momentum[c.world].beta);
    impulse[i] = u.impulse;
    extrapolated[i] = u.extrapolated;
    progress[i] = u.progress;
    residual_square[i] = u.residual_square;
  }
};

struct UpdateMotor {
  View<const Motor> motor;
  View<const Velocity> velocity;
  View<const BodyMass> mass;
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Real> impulse, extrapolated;
  Real step;

  GONOGO_HD void operator()(Index i) const {
    const Motor& m = motor[i];
    if (momentum[world_of_body[m.body]].phase == Phase::done) return;
    const Real limit = m.max_torque * step;
    const Real excess = velocity[m.body].angular.y - m.speed;
    const Real wish = extrapolated[i] - excess / (2 * mass[m.body].inverse_inertia_B.y);
    const Real next = std::fmin(limit, std::fmax(-limit, wish));
    const Real beta = momentum[world_of_body[m.body]].beta;
    extrapolated[i] = next + beta * (next - impulse[i]);
    impulse[i] = next;
  }
};

/// Sum of a quantity over the contacts that a body owns.
struct SumOwned {
  Incidence incidence;
  View<const Real> of_contact;
  View<Real> of_body;
  GONOGO_HD void operator()(BodyIndex b) const {
    Real sum = 0;
    for (Index i = incidence.owned_begin(b); i < incidence.owned_end(b); ++i) sum += of_contact[i];
    of_body[b] = sum;
  }
};

/// Momentum of the next iteration: restarts where the last one went uphill.
struct UpdateMomentum {
  View<const WorldParameters> world;
  View<const Real> body_progress;
  View<Momentum> momentum;
  Index most_iterations;

  GONOGO_HD void operator()(WorldIndex w) const {
    Momentum& m = momentum[w];
    if (m.phase == Phase::done) return;
    ++m.iterations;
    if (m.phase == Phase::last) {
      m.phase = Phase::done;
      return;
    }
    Real uphill = 0;
    for (Index b = world[w].first_body; b < world[w].first_body + world[w].body_count; ++b) uphill += body_progress[b];
    if (uphill > 0) m.t = 1;
    const Real next = (1 + std::sqrt(1 + 4 * m.t * m.t)) / 2;
    m.beta = (m.t - 1) / next;
    m.t = next;
    // No extrapolation in the last update, so that it ends on admissible impulses.
    if (m.iterations + 1 >= most_iterations) m.phase = Phase::last, m.beta = 0;
  }
};

/// Sends a world into its last update when its residual is small enough; counts the worlds still at work.
struct TestConvergence {
  View<const WorldParameters> world;
  View<const Real> residual_square;  // [body]
  Incidence incidence;
  View<Momentum> momentum;
  View<Index> worlds_iterating;
  Real tolerance;

  GONOGO_HD void operator()(WorldIndex w) const {
    Momentum& m = momentum[w];
    if (m.phase == Phase::done) return;
    const BodyIndex first = world[w].first_body, end = first + world[w].body_count;
    Real sum = 0;
    for (BodyIndex b = first; b < end; ++b) sum += residual_square[b];
    const Index count = incidence.owned_end(end - 1) - incidence.owned_begin(first);
    if (sum <= tolerance * tolerance * Real(count)) m.phase = Phase::last, m.beta = 0;
    atomic_increment(worlds_iterating[0]);
  }
};

/// The warm start is close to the solution, so momentum starts as it would stand after a few iterations; the restart
/// takes it back where that is too bold. Measured on a driven wheel at 10 iterations: a third less residual than from t
/// = 1.
inline constexpr Real kFirstMomentum = 4;

struct ResetMomentum {
  View<Momentum> momentum;
  bool single;  // only one iteration is wanted: it is the last
  GONOGO_HD void operator()(WorldIndex w) const {
    const Real next = (1 + std::sqrt(1 + 4 * kFirstMomentum * kFirstMomentum)) / 2;
    momentum[w] = {next, single ? Real(0) : (kFirstMomentum - 1) / next, single ? Phase::last : Phase::iterating, 0};
  }
};

/// Scaled natural map of the CCP per contact [m/s]: the change that one unsplit projected gradient step would still
/// make, divided by that step, so that light grains count as much as wheels. Zero exactly at the solution.
struct MeasureResidual {
  View<const Contact> contact;
  View<const Velocity> velocity;
  View<const Impulse> impulse;
  View<Real> residual;

  GONOGO_HD void operator()(Index i) const {
    const Contact& c = contact[i];
    const ConeStep step{c.step.n * c.unsplit, c.step.t * c.unsplit, c.step.r * c.unsplit};
    const Impulse from = impulse[i];
    const Impulse next =
        projected_step<Real>(c, from, contact_gradient<Real>(c, velocity[c.body_a], velocity[c.body_b]), step);
    residual[i] = std::sqrt(residual_square<Real>(c, next.linear - from.linear, next.angular - from.angular, step));
  }
};

template <class Exec>
GatherVelocity gather(State<Exec>& s) {
  return {incidence(s),           s.contact.view(),           s.extrapolated.view(),
          s.mass.view(),          s.inverse_inertia_W.view(), s.motor_extrapolated.view(),
          s.free_velocity.view(), s.progress.view(),          s.world_of_body.view(),
          s.momentum.view(),      s.velocity.view(),          s.body_progress.view()};
}

/// The residual of the latest update is summed and tested after every so many iterations. It belongs to the split
/// steps, which makes it an upper bound of the one that is reported.
inline constexpr Index kTestEvery = 5;

/// Whether any world still iterates, after sending those within tolerance into their last update.
template <class Exec>
bool any_iterating(Exec exec, State<Exec>& s, Real tolerance) {
  for_each_index(exec, s.body_count, SumOwned{incidence(s), s.residual_square.view(), s.body_progress.view()});
  s.worlds_iterating.fill_zero(1);
  for_each_index(exec, s.world_count,
                 TestConvergence{s.world.view(), s.body_progress.view(), incidence(s), s.momentum.view(),
                                 s.worlds_iterating.view(), tolerance});
  return s.worlds_iterating.read(0) > 0;
}

template <class Exec>
void begin_updates(Exec, State<Exec>&) {}

template <class Exec>
void update_contacts(Exec exec, State<Exec>& s) {
  for_each_index(exec, s.contact_count,
                 UpdateContact{s.contact.view(), s.velocity.view(), s.momentum.view(), s.impulse.view(),
                               s.extrapolated.view(), s.progress.view(), s.residual_square.view()});
}

template <class Exec>
void end_updates(Exec, State<Exec>&) {}

#ifndef __CUDACC__
// On the host eight contacts are updated at once; their impulses live in the blocks meanwhile.
inline void begin_updates(Cpu exec, State<Cpu>& s) {
  s.block.resize((s.contact_count + kPackWidth - 1) / kPackWidth);
  for_each_index(exec, s.block.size(), FillBlock{s.contact.view(), s.impulse.view(), s.block.view()});
}

inline void update_contacts(Cpu exec, State<Cpu>& s) {
  for_each_index(exec, s.block.size(),
                 UpdateBlock{s.block.view(), s.contact.view(), s.velocity.view(), s.momentum.view(),
                             s.extrapolated.view(), s.progress.view(), s.residual_square.view()});
}

/// After the last update, which does not extrapolate, both kinds of impulse are the same.
inline void end_updates(Cpu, State<Cpu>& s) { s.impulse.swap(s.extrapolated); }
#endif

/// From the warm start in `impulse` to the end-of-step velocities.
template <class Exec>
void solve_apgd(Exec exec, State<Exec>& s, const StepSettings& settings) {
  for_each_index(
      exec, s.contact_count,
      PrepareContact{incidence(s), s.mass.view(), s.contact.view(), s.impulse.view(), s.extrapolated.view()});
  for_each_index(exec, s.world_count, ResetMomentum{s.momentum.view(), settings.iterations == 1});
  for_each_index(exec, s.body_count, gather(s));
  begin_updates(exec, s);
  for (Index k = 0; k < settings.iterations; ++k) {
    update_contacts(exec, s);
    for_each_index(exec, s.motor.size(),
                   UpdateMotor{s.motor.view(), s.velocity.view(), s.mass.view(), s.world_of_body.view(),
                               s.momentum.view(), s.motor_impulse.view(), s.motor_extrapolated.view(), settings.step});
    for_each_index(exec, s.body_count, gather(s));
    for_each_index(exec, s.world_count,
                   UpdateMomentum{s.world.view(), s.body_progress.view(), s.momentum.view(), settings.iterations});
    if (settings.tolerance > 0 && k % kTestEvery == kTestEvery - 1 && !any_iterating(exec, s, settings.tolerance))
      break;
  }
  end_updates(exec, s);
}

}  // namespace gonogo::sim
