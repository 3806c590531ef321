// The penalty family as a stage of the step, on either backend. Forces follow from the overlaps and velocities at the
// step's start, velocities from the forces, positions from the new velocities (symplectic Euler, the leapfrog with
// velocities given half a step early). Nothing is iterated but the motors. sim/scene/penalty_setup.h bounds the step.
#pragma once
#include "base/parallel/team.h"
#include "sim/constraint/contact_finder.h"
#include "sim/constraint/project_joints.h"
#include "sim/law/penalty_force.h"
#include "sim/solver/segmented_scan.h"
#include "sim/solver/shared_stages.h"
#include "sim/state/mechanism.h"
#include "sim/state/state.h"

namespace gonogo::sim {

template <class Exec>
struct PenaltyStorage {
  Buffer<Wrench, Exec> wrench_a, wrench_b;                       // [contact] on body a; [slot] on body b
  Buffer<WorldSums, Exec> body_tile_measures, measures_of_lane;  // [body tile], [world * kSumLanes]
};

/// Effective radius of a contact [m]: r1 r2 / (r1 + r2) of round shapes, the radius of the one that is round, or the
/// smaller of the smallest half extents.
GONOGO_HD inline Real penalty_radius(const Shape& a, const Shape& b) {
  if (const Real round = rolling_radius(a, b); round > 0) return round;
  const Real ha = smallest_half(a), hb = smallest_half(b);
  return ha > 0 && hb > 0 ? std::fmin(ha, hb) : std::fmax(ha, hb);
}

/// Impulse and history of a contact, and its wrenches on both bodies.
template <class Law>
struct PushContact {
  View<const ContactPair> pair;
  View<const Shape> shape;
  View<const Vec3d> centre;
  View<const WorldParameters> world;
  View<const PenaltyNumbers> law;
  View<const BodyMass> mass;
  View<const Velocity> velocity;
  View<const Contact> contact;
  View<const std::uint64_t> key, old_key;
  View<const Index> old_begin, old_end;  // [shape]
  View<const ContactHistory> old_history;
  View<const Index> second_slot;
  View<Impulse> impulse;
  View<ContactHistory> history;
  View<Wrench> wrench_a, wrench_b;
  Real step;

  GONOGO_HD void operator()(ContactIndex i) const {
    const Contact& c = contact[i];
    const ContactPair p = pair[i];
    const Shape &a = shape[p.owner], &b = shape[p.other];
    GONOGO_ASSERT(a.body == c.body_a && b.body == c.body_b);
    ContactHistory h = remembered(p, int(std::uint32_t(key[i])));
    const PenaltyForce f = penalty_force<Law>(seen(c, p, a, b), law[numbers_of(c.world, a, b)], step, h);
    Impulse given;
    given.linear = f.force * step;
    given.angular = f.moment * step;
    impulse[i] = given;
    store_words(history[i], h);
    wrench_a[i] = {given.linear, 0, moment(c.arm_a, given), 0};
    if (const Index slot = second_slot[i]; slot >= 0) wrench_b[slot] = {-given.linear, 0, -moment(c.arm_b, given), 0};
  }

  GONOGO_HD static Index numbers_of(WorldIndex w, const Shape& a, const Shape& b) {
    GONOGO_ASSERT(is_material(a.material) && is_material(b.material));
    return w * kPenaltyPairs + a.material * kMaxMaterials + b.material;
  }

  GONOGO_HD PenaltyContact seen(const Contact& c, const ContactPair& p, const Shape& a, const Shape& b) const {
    const Velocity va = velocity[c.body_a], vb = velocity[c.body_b];
    const PairLaw& pair_law = world[c.world].law[a.material][b.material];
    PenaltyContact s;
    s.normal = c.normal;
    s.gap = precise_gap(c, p, a, b);
    s.velocity = contact_velocity<Real>(c, va, vb);
    s.turn = va.angular - vb.angular;
    s.mean_spin = dot(va.angular + vb.angular, c.normal) / 2;
    const Vec3 inverse = mass[c.body_a].inverse_mass + mass[c.body_b].inverse_mass;
    const Real along = dot(inverse, scale(c.normal, c.normal));
    s.mass = along > 0 ? 1 / along : Real(0);  // 0: neither can move along the normal
    s.radius = penalty_radius(a, b);
    s.mu = c.mu;
    s.rho = c.rho;
    s.sigma = c.sigma;
    s.cohesion = c.cohesion / step;
    s.stiffness = pair_law.stiffness;
    s.damping = pair_law.damping;
    return s;
  }

  /// Overlaps are millionths of a radius, about what a contact's gap in single precision resolves between spheres.
  GONOGO_HD Real precise_gap(const Contact& c, const ContactPair& p, const Shape& a, const Shape& b) const {
    if (a.type != ShapeType::sphere || b.type != ShapeType::sphere) return c.gap;
    const WorldParameters& w = world[c.world];
    const Vec3d apart = nearest_image(
        ContactFinder::folded_centre(centre[p.owner], w) - ContactFinder::folded_centre(centre[p.other], w), w.period);
    return Real(std::sqrt(dot(apart, apart)) - (double(a.size.x) + double(b.size.x)));
  }

  /// What the contact of this name was in the step before. The other shape may have owned it then.
  GONOGO_HD ContactHistory remembered(const ContactPair& p, int feature) const {
    ContactHistory h;
    if (const ContactIndex own = old_contact(p.owner, pair_key(p.other, feature)); own >= 0) {
      h = old_history[own];
    } else if (const ContactIndex other = old_contact(p.other, pair_key(p.owner, feature)); other >= 0) {
      h = old_history[other];
      h.force = -h.force;
      h.moment = -h.moment;
      h.normal = -h.normal;
    }
    return h;
  }

  GONOGO_HD ContactIndex old_contact(ShapeIndex owner, std::uint64_t name) const {
    for (ContactIndex k = old_begin[owner]; k < old_end[owner]; ++k)
      if (old_key[k] == name) return k;
    return -1;
  }
};

/// Velocity of a body after the step. Bodies of a mechanism leave it in `free_velocity`, for SettleMechanism.
struct PushBody {
  Incidence incidence;
  View<const Wrench> wrench_a, wrench_b;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  View<const Velocity> change;
  View<Velocity> velocity, free_velocity;

  GONOGO_HD void operator()(BodyIndex b) const {
    const BodyMass m = mass[b];
    Vec3 linear, angular;
    if (!is_fixed(m)) {
      for (Index i = incidence.owned_begin(b); i < incidence.owned_end(b); ++i) add(wrench_a[i], linear, angular);
      for (Index k = incidence.first_second[b]; k < incidence.first_second[b + 1]; ++k)
        add(wrench_b[k], linear, angular);
    }
    const SymMat3 inertia = m.isotropic ? SymMat3{} : inverse_inertia_W[b];
    const Velocity next = driven_velocity(sum(velocity[b], change[b]), m, inertia, linear, angular);
    (m.slot >= 0 ? free_velocity : velocity)[b] = next;
  }

  GONOGO_HD static void add(const Wrench& w, Vec3& linear, Vec3& angular) {
    linear += w.linear;
    angular += w.angular;
  }
};

/// Updates of a mechanism's motors in a step. One settles a single motor; several go on from the step before.
inline constexpr int kMotorUpdates = 4;

/// Motors and joints of a mechanism, to which contacts are given forces. One team of threads each.
struct SettleMechanism {
  Projection projection;
  View<const Element> element;
  View<const Motor> motor;
  View<const MotorDrive> drive;
  MotorMoment moment;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  View<const Velocity> free_velocity;
  View<Velocity> velocity, gathered;
  View<Real> motor_impulse;
  Real step;

  template <class Team>
  GONOGO_HD void operator()(const Team& team, Index index) const {
    const Mechanism& m = projection.mechanism[index];
    move(team, m);
    for (int k = 0; k < (m.motor_count > 0 ? kMotorUpdates : 0); ++k) {
      const Index first = m.first_element + m.element_count - m.motor_count;
      for (Index i = team.rank(); i < m.motor_count; i += team.size()) update(element[first + i].index);
      team.sync();
      move(team, m);
    }
  }

  /// The motors have the mechanism's masses to themselves: twice the step for which contacts leave them half.
  GONOGO_HD void update(Index i) const {
    MotorDrive whole = drive[i];
    GONOGO_ASSERT(whole.step > 0);
    whole.step *= 2;
    const Real speed = motor_speed(motor[i], whole.axis_W, velocity);
    motor_impulse[i] = updated_motor(motor[i], whole, motor_impulse[i], speed, step);
  }

  template <class Team>
  GONOGO_HD void move(const Team& team, const Mechanism& m) const {
    for (Index k = m.first_body + team.rank(); k < m.first_body + m.body_count; k += team.size()) gather(k);
    team.sync();
    for (Index k = m.first_body + team.rank(); k < m.first_body + m.body_count; k += team.size()) {
      Velocity next[1];
      projection.velocities(k, next);
      velocity[projection.body[k].body] = next[0];
    }
    team.sync();
  }

  GONOGO_HD void gather(Index k) const {
    const BodyIndex b = projection.body[k].body;
    const SymMat3 inertia = mass[b].isotropic ? SymMat3{} : inverse_inertia_W[b];
    gathered[k] = driven_velocity(free_velocity[b], mass[b], inertia, {}, moment(k));
  }
};

/// Energies of a world; there is no residual.
struct AddPenaltyMeasures {
  View<const WorldParameters> world;
  View<const Index> first_contact;
  View<const WorldSums> measures_of_lane;
  View<WorldSums> sums;

  GONOGO_HD void operator()(WorldIndex w) const {
    WorldSums total = sum_over_lanes(measures_of_lane, w);
    const ContactRange r = contacts_of_world(world[w], first_contact);
    total.contact_count = r.end - r.begin;
    total.iterations = 1;
    sums[w] = total;
  }
};

template <class Exec>
void reserve_penalty(const State<Exec>& s, PenaltyStorage<Exec>& own) {
  own.wrench_a.resize(std::size_t(s.contact_capacity));
  own.wrench_b.resize(std::size_t(s.contact_capacity));
  own.body_tile_measures.resize(std::size_t(s.world_of_body_tile.size()));
  own.measures_of_lane.resize(std::size_t(s.world_count) * kSumLanes);
}

template <class Law, class Exec>
PushContact<Law> contact_push(State<Exec>& s, PenaltyStorage<Exec>& own, const StepSettings& settings) {
  ContactStore<Exec>&now = s.store[s.parity], &old = s.store[1 - s.parity];
  return {.pair = s.pair.view(),
          .shape = s.shape.view(),
          .centre = s.centre.view(),
          .world = s.world.view(),
          .law = s.penalty.view(),
          .mass = s.mass.view(),
          .velocity = s.velocity.view(),
          .contact = s.contact.view(),
          .key = now.key.view(),
          .old_key = old.key.view(),
          .old_begin = old.begin.view(),
          .old_end = old.end.view(),
          .old_history = old.history.view(),
          .second_slot = s.second_slot.view(),
          .impulse = now.impulse.view(),
          .history = now.history.view(),
          .wrench_a = own.wrench_a.view(),
          .wrench_b = own.wrench_b.view(),
          .step = settings.step};
}

template <class Exec>
SettleMechanism mechanism_settling(State<Exec>& s, const StepSettings& settings) {
  MechanismStore<Exec>& m = s.mechanisms;
  return {.projection = projection(m),
          .element = m.element.view(),
          .motor = m.motor.view(),
          .drive = m.drive.view(),
          .moment = motor_moment(m),
          .mass = s.mass.view(),
          .inverse_inertia_W = s.inverse_inertia_W.view(),
          .free_velocity = s.free_velocity.view(),
          .velocity = s.velocity.view(),
          .gathered = m.gathered.view(),
          .motor_impulse = m.motor_impulse.view(),
          .step = settings.step};
}

template <class Exec>
void measure_penalty(Exec exec, State<Exec>& s, PenaltyStorage<Exec>& own) {
  measure_body_tiles(exec, s, own.body_tile_measures.view());
  for_each_index(
      exec, own.measures_of_lane.size(),
      SumByLanes<WorldSums>{s.first_body_tile.view(), own.body_tile_measures.view(), own.measures_of_lane.view()});
  for_each_index(
      exec, s.world_count,
      AddPenaltyMeasures{s.world.view(), s.first_contact.view(), own.measures_of_lane.view(), s.world_sums.view()});
}

/// From the contacts of the step to its impulses, histories and velocities. Call reserve_penalty before.
template <class Exec>
void solve_by_penalty(Exec exec, State<Exec>& s, PenaltyStorage<Exec>& own, const StepSettings& settings) {
  GONOGO_ASSERT(is_penalty(settings.contact) && s.remembers && settings.substeps == 1);
  GONOGO_ASSERT(settings.give <= 0);
  GONOGO_ASSERT(own.wrench_a.size() == s.contact_capacity && own.wrench_b.size() == s.contact_capacity);
  with_penalty_law(settings.contact, [&](auto law) {
    for_each_counted(exec, contact_count(s), contact_push<decltype(law)>(s, own, settings));
  });
  for_each_index(exec, s.body_count,
                 PushBody{.incidence = incidence(s),
                          .wrench_a = own.wrench_a.view(),
                          .wrench_b = own.wrench_b.view(),
                          .mass = s.mass.view(),
                          .inverse_inertia_W = s.inverse_inertia_W.view(),
                          .change = s.velocity_change.view(),
                          .velocity = s.velocity.view(),
                          .free_velocity = s.free_velocity.view()});
  for_each_team(exec, s.mechanisms.mechanism.size(), mechanism_settling(s, settings));
  measure_penalty(exec, s, own);
}

/// Bytes of a step's forces if each record is moved once. A contact: its record, its history read and written, its
/// impulse, two names, two wrenches written and read. A body: mass, two velocities read and one written.
template <class Exec>
double penalty_traffic(const State<Exec>& s, Index contacts) {
  constexpr double of_contact =
      sizeof(Contact) + 2 * sizeof(ContactHistory) + sizeof(Impulse) + 2 * sizeof(std::uint64_t) + 4 * sizeof(Wrench);
  constexpr double of_body = sizeof(BodyMass) + 3 * sizeof(Velocity);
  return double(contacts) * of_contact + double(s.body_count) * of_body;
}

}  // namespace gonogo::sim
