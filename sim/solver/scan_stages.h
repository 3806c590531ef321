// The loops of `jacobi_scan` over contacts, bodies, tiles and worlds; see jacobi_scan.h.
#pragma once
#include "sim/solver/scan_storage.h"
#include "sim/solver/segmented_scan.h"
#include "sim/solver/shared_stages.h"

namespace gonogo::sim {

GONOGO_HD_INLINED Wrench operator+(const Wrench& a, const Wrench& b) {
  return {a.linear + b.linear, 0, a.angular + b.angular, 0};
}
GONOGO_HD_INLINED WorldSums operator+(const WorldSums& a, const WorldSums& b) {
  WorldSums sum = a;
  return sum += b;
}

struct BodyOfSlot {
  View<const BodyIndex> body;
  GONOGO_HD Index operator()(Index slot) const { return body[slot]; }
};

/// Slots of a body. `shift`: of its world, from places counted without the unused slots of the worlds' last runs.
struct SlotsOfBody {
  Incidence incidence;
  View<const Index> shift;

  GONOGO_HD Index begin(BodyIndex b, WorldIndex w) const {
    return incidence.owned_begin(b) + incidence.first_second[b] + shift[w];
  }
  /// Behind the slots of the contacts it owns.
  GONOGO_HD Index middle(BodyIndex b, WorldIndex w) const {
    return incidence.owned_end(b) + incidence.first_second[b] + shift[w];
  }
  GONOGO_HD Index end(BodyIndex b, WorldIndex w) const {
    return incidence.owned_end(b) + incidence.first_second[b + 1] + shift[w];
  }
};

struct CountSlots {
  View<const WorldParameters> world;
  View<const Index> first_contact, first_second;
  View<Index> slots_of_world;

  GONOGO_HD void operator()(WorldIndex w) const {
    const WorldParameters& p = world[w];
    const ContactRange r = contacts_of_world(p, first_contact);
    const Index second = first_second[p.first_body + p.body_count] - first_second[p.first_body];
    slots_of_world[w] = scan_runs(r.end - r.begin + second) * kScanRun;
  }
};

struct ShiftSlots {
  View<const WorldParameters> world;
  View<const Index> first_contact, first_second, first_slot;
  View<Index> shift;

  GONOGO_HD void operator()(WorldIndex w) const {
    const ContactRange r = contacts_of_world(world[w], first_contact);
    shift[w] = first_slot[w] - r.begin - first_second[world[w].first_body];
  }
};

/// Writes the wrenches of a contact into the slots of its bodies.
struct WrenchSlots {
  View<const SlotPair> slot;
  View<Wrench> wrench;

  GONOGO_HD_INLINED void write(ContactIndex i, const ContactNumbers<Real>& c, const Impulse& p) const {
    const SlotPair at = slot[i];
    wrench[at.a] = {p.linear, 0, moment(c.arm_a, p), 0};
    if (at.b >= 0) wrench[at.b] = {-p.linear, 0, -moment(c.arm_b, p), 0};
  }
};

/// Starts a contact: its step sizes, its slots, and its warm start in them.
struct EnterContact {
  SplitMasses split;
  SlotsOfBody place;
  View<const Index> second_slot;  // see incidence.h
  View<const Impulse> impulse;
  View<SlotPair> slot;
  View<BodyIndex> body;
  WrenchSlots slots;

  GONOGO_HD void operator()(ContactIndex i) const {
    split(i);
    const Contact& c = split.contact[i];
    const Index first_owned = place.incidence.owned_begin(c.body_a),
                first_second = place.incidence.first_second[c.body_b];
    const SlotPair at{place.begin(c.body_a, c.world) + i - first_owned,
                      second_slot[i] >= 0 ? place.middle(c.body_b, c.world) + second_slot[i] - first_second : -1};
    slot[i] = at;
    body[at.a] = c.body_a;
    if (at.b >= 0) body[at.b] = c.body_b;
    slots.write(i, c, impulse[i]);
  }
};

/// One update of a contact; `turning` as in projected_step.
template <bool turning>
struct UpdateByScan {
  View<Contact> contact;
  View<Impulse> impulse;
  View<const Velocity> velocity, substep_velocity;
  View<const Momentum> momentum;
  WrenchSlots slots;
  View<Real> residual_square_of;  // [contact]
  StepSettings settings;

  GONOGO_HD void operator()(ContactIndex i) const {
    Contact& c = contact[i];
    const Momentum& m = momentum[c.world];
    if (m.done) return;
    if (m.begins) advance_gap(c, substep_velocity[c.body_a], substep_velocity[c.body_b], settings);
    const Velocity a = velocity[c.body_a], b = velocity[c.body_b];
    if (m.renew_slip) c.bias = c.gap_bias + opening_speed<turning, Real>(c, a, b);
    const ContactNumbers<Real> numbers = c;
    const Impulse now = impulse[i];
    const ContactUpdate<Real> u = accelerated_update<turning, Real>(numbers, a, b, now, now, Real(0));
    impulse[i] = u.impulse;
    if (m.test) residual_square_of[i] = residual_square<turning, Real>(numbers, u);
    slots.write(i, numbers, u.impulse);
  }
};

/// Velocity of a body from the scanned wrenches; jointed bodies follow from ProjectMechanism.
struct MoveByScan {
  SlotsOfBody place;
  View<const Wrench> scanned;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  MotorMoment motor_moment;
  View<const Velocity> free_velocity;
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Velocity> velocity, extrapolated_velocity;  // the same: plain steps have no momentum
  View<Velocity> gathered;                         // [mechanism body]

  GONOGO_HD void operator()(BodyIndex b) const {
    const WorldIndex w = world_of_body[b];
    if (momentum[w].done) return;
    const BodyMass m = mass[b];
    Wrench sum;
    if (!is_fixed(m)) sum = segment_sum(scanned, place.begin(b, w), place.end(b, w));
    if (m.slot >= 0) sum.angular += motor_moment(m.slot);
    const SymMat3 inverse_inertia = m.isotropic ? SymMat3{} : inverse_inertia_W[b];
    const Velocity next = driven_velocity(free_velocity[b], m, inverse_inertia, sum.linear, sum.angular);
    if (m.slot >= 0) {
      gathered[m.slot] = next;
      return;
    }
    velocity[b] = extrapolated_velocity[b] = next;
  }
};

struct SumTileResiduals {
  Tiles tiles;
  View<const Momentum> momentum;
  View<const Real> residual_square;
  View<double> sum;  // [tile]

  GONOGO_HD void operator()(Index t) const {
    if (t >= tiles.count()) return;
    double s = 0;
    const ContactRange range = tiles.contacts(t);
    if (momentum[tiles.tile[t].world].test)
      for (ContactIndex i = range.begin; i < range.end; ++i) s += double(residual_square[i]);
    sum[t] = s;
  }
};

/// Decides the next update of a world. Steps without momentum need only the residual's sum.
struct DecideByScan {
  Tiles tiles;
  View<const double> residual_of_lane;
  View<Momentum> momentum;
  IterationRules rules;

  GONOGO_HD void operator()(WorldIndex w) const {
    if (momentum[w].done) return;
    UpdateSums sums;
    if (momentum[w].test) sums.residual_square = sum_over_lanes(residual_of_lane, w);
    const ContactRange r = contacts_of_world(tiles.world[w], tiles.first_contact);
    decide_next_update(momentum[w], sums, r.end - r.begin, rules);
  }
};

struct BeginWorld {
  View<Momentum> momentum;
  IterationRules rules;
  GONOGO_HD void operator()(WorldIndex w) const { momentum[w] = first_momentum(rules); }
};

/// Energies of the bodies of a run of one world.
struct MeasureBodyTile {
  View<const WorldParameters> world;
  View<const Index> first_body_tile, world_of_body_tile;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<WorldSums> sums;  // [body tile]

  GONOGO_HD void operator()(Index t) const {
    const WorldIndex w = world_of_body_tile[t];
    const WorldParameters& p = world[w];
    const Index begin = (t - first_body_tile[w]) * kTileSize, full = begin + kTileSize;
    const Index end = full < p.body_count ? full : p.body_count;
    WorldSums s;
    for (BodyIndex b = p.first_body + begin; b < p.first_body + end; ++b)
      s += energy_of_body(mass[b], orientation[b], velocity[b], p.gravity);
    sums[t] = s;
  }
};

struct AddMeasures {
  Tiles tiles;
  View<const WorldSums> contacts_of_lane, bodies_of_lane;
  View<const Momentum> momentum;
  View<WorldSums> sums;

  GONOGO_HD void operator()(WorldIndex w) const {
    WorldSums total = sum_over_lanes(contacts_of_lane, w) + sum_over_lanes(bodies_of_lane, w);
    const ContactRange r = contacts_of_world(tiles.world[w], tiles.first_contact);
    total.contact_count = r.end - r.begin;
    total.iterations = momentum[w].updates;
    sums[w] = total;
  }
};

}  // namespace gonogo::sim
