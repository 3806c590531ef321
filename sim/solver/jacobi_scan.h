// `jacobi_scan`: the baseline to which the fast iterations are compared. It takes the steps of `jacobi`, but impulses
// reach the bodies as in the first solvers of this family on GPUs (Tasora & Negrut 2009; Negrut et al. 2012). Every
// contact writes its two wrenches into slots sorted by body, a segmented scan sums the slots of each body, then all
// bodies move. (In Chrono's code of 2012, src/unit_PARALLEL/ChLcpSolverGPU.cu, one thread per body sums its slots.)
// Those solvers added changes of velocity; here slots hold whole impulses, so that rounding does not accumulate. Each
// stage is a loop of its own, on either backend.
#pragma once
#include <type_traits>

#include "sim/solver/segmented_scan.h"
#include "sim/solver/shared_stages.h"
#include "sim/state/state.h"

namespace gonogo::sim {

/// Slots of a contact's two wrenches; b is -1 for a fixed body b.
struct alignas(8) SlotPair {
  Index a, b;
};

/// Slots are in the order of the bodies: for each the contacts it owns, then those where it is body b. Each world
/// starts a new run of the scan, so that its sums do not depend on the other worlds.
template <class Exec>
struct ScanStorage {
  Buffer<SlotPair, Exec> slot;                     // [contact]
  Buffer<BodyIndex, Exec> body;                    // [slot]
  Buffer<Wrench, Exec> wrench;                     // [slot] then scanned
  Buffer<Index, Exec> slots_of_world, first_slot;  // [world] whole runs, [world + 1]
  Buffer<Index, Exec> shift;                       // [world] see SlotsOfBody
  ScanScratch<Exec> scratch;
  Buffer<Real, Exec> residual_square;                         // [contact] of an update that tests [m^2/s^2]
  Buffer<double, Exec> tile_residual, residual_of_lane;       // [tile], [world * kSumLanes]
  Buffer<WorldSums, Exec> tile_measures, body_tile_measures;  // [tile], [body tile]
  Buffer<WorldSums, Exec> contacts_of_lane, bodies_of_lane;   // [world * kSumLanes]
  Buffer<Real, Exec> motor_before;                            // [motor]
};

GONOGO_HD_INLINED Wrench operator+(const Wrench& a, const Wrench& b) {
  return {a.linear + b.linear, 0, a.angular + b.angular, 0};
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
  View<const Index> second_slot;  // see contact_lists.h
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
    GONOGO_ASSERT(at.a < place.middle(c.body_a, c.world) && at.b < place.end(c.body_b, c.world));
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
    if (m.begins) advance_gap(c, substep_velocity[c.body_a], substep_velocity[c.body_b], impulse[i].linear, settings);
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

/// The stages of a step's iterations, in the order of solve_by_scan.
template <class Exec>
class ScanIteration {
 public:
  ScanIteration(Exec exec, State<Exec>& state, ScanStorage<Exec>& storage, const StepSettings& settings)
      : exec_(exec), s(state), own(storage), settings_(settings), rules_(settings.rules()) {}

  void begin() {
    for_each_index(exec_, s.world_count, BeginWorld{s.momentum.view(), rules_});
    lay_out_slots();
    for_each_counted(exec_, contact_count(s),
                     EnterContact{.split = mass_splitting(s, settings_),
                                  .place = place(),
                                  .second_slot = s.second_slot.view(),
                                  .impulse = s.store[s.parity].impulse.view(),
                                  .slot = own.slot.view(),
                                  .body = own.body.view(),
                                  .slots = slots()});
    begin_bodies(exec_, s);
  }

  void update() {
    s.turning ? update_contacts<true>() : update_contacts<false>();
    for_each_index(exec_, s.mechanisms.motor.size(), motor_update(s, own.motor_before.view(), settings_));
  }

  /// Moves the bodies by the present impulses. `first`: those of the warm start.
  void move(bool first) {
    for_each_index(
        exec_, scan_runs(own.wrench.size()),
        ScanRun<Wrench, BodyOfSlot>{{own.body.view()}, own.wrench.view(), own.first_slot.data() + s.world_count});
    for_each_index(exec_, s.body_count,
                   MoveByScan{.place = place(),
                              .scanned = own.wrench.view(),
                              .mass = s.mass.view(),
                              .inverse_inertia_W = s.inverse_inertia_W.view(),
                              .motor_moment = motor_moment(s.mechanisms),
                              .free_velocity = s.free_velocity.view(),
                              .world_of_body = s.world_of_body.view(),
                              .momentum = s.momentum.view(),
                              .velocity = s.velocity.view(),
                              .extrapolated_velocity = s.extrapolated_velocity.view(),
                              .gathered = s.mechanisms.gathered.view()});
    project(first, false);
  }

  /// Carries bodies into the next substep, in worlds where one follows.
  void carry() {
    if (rules_.substeps == 1) return;
    for_each_index(exec_, s.body_count, body_carry(s));
    project(false, true);
  }

  void decide() {
    if (rules_.tolerance > 0) {
      for_each_index(
          exec_, tile_capacity(s),
          SumTileResiduals{tiles(s), s.momentum.view(), own.residual_square.view(), own.tile_residual.view()});
      sum_by_lanes(s.first_tile, own.tile_residual, own.residual_of_lane);
    }
    for_each_index(exec_, s.world_count,
                   DecideByScan{tiles(s), own.residual_of_lane.view(), s.momentum.view(), rules_});
  }

  void measure() {
    for_each_index(exec_, tile_capacity(s),
                   MeasureTile{tiles(s), s.contact.view(), s.velocity.view(), s.store[s.parity].impulse.view(),
                               own.tile_measures.view(), settings_.target});
    measure_body_tiles(exec_, s, own.body_tile_measures.view());
    sum_by_lanes(s.first_tile, own.tile_measures, own.contacts_of_lane);
    sum_by_lanes(s.first_body_tile, own.body_tile_measures, own.bodies_of_lane);
    for_each_index(exec_, s.world_count,
                   AddMeasures{tiles(s), own.contacts_of_lane.view(), own.bodies_of_lane.view(), s.momentum.view(),
                               s.world_sums.view()});
  }

 private:
  void lay_out_slots() {
    const View<const Index> first_contact = s.first_contact.view(), first_second = s.first_second.view();
    for_each_index(exec_, s.world_count,
                   CountSlots{s.world.view(), first_contact, first_second, own.slots_of_world.view()});
    exclusive_scan(exec_, own.slots_of_world.view(), own.first_slot.view(), own.scratch);
    for_each_index(exec_, s.world_count,
                   ShiftSlots{s.world.view(), first_contact, first_second, own.first_slot.view(), own.shift.view()});
  }

  SlotsOfBody place() { return {incidence(s), own.shift.view()}; }
  WrenchSlots slots() { return {own.slot.view(), own.wrench.view()}; }

  template <bool turning>
  void update_contacts() {
    for_each_counted(exec_, contact_count(s),
                     UpdateByScan<turning>{.contact = s.contact.view(),
                                           .impulse = s.store[s.parity].impulse.view(),
                                           .velocity = s.extrapolated_velocity.view(),
                                           .substep_velocity = s.substep_velocity.view(),
                                           .momentum = s.momentum.view(),
                                           .slots = slots(),
                                           .residual_square_of = own.residual_square.view(),
                                           .settings = settings_});
  }

  void project(bool first, bool carried) {
    for_each_index(exec_, s.mechanisms.body.size(), mechanism_projection(s, first, carried));
  }

  template <class T>
  void sum_by_lanes(Buffer<Index, Exec>& first, Buffer<T, Exec>& value, Buffer<T, Exec>& of_lane) {
    for_each_index(exec_, of_lane.size(), SumByLanes<T>{first.view(), value.view(), of_lane.view()});
  }

  Exec exec_;
  State<Exec>& s;
  ScanStorage<Exec>& own;
  StepSettings settings_;
  IterationRules rules_;
};

/// Whether all worlds have ended, if the host can see it. On the GPU the queue continues, and ended worlds do nothing.
template <class Exec>
bool seen_to_end(const State<Exec>& s) {
  if constexpr (std::is_same_v<Exec, Cpu>) {
    for (WorldIndex w = 0; w < s.world_count; ++w)
      if (!s.momentum.read(w).done) return false;
    return true;
  }
  return false;
}

template <class Exec>
void reserve_scan(const State<Exec>& s, ScanStorage<Exec>& own, const StepSettings& settings) {
  const std::size_t contacts = std::size_t(s.contact_capacity), tiles = std::size_t(tile_capacity(s)),
                    worlds = std::size_t(s.world_count), slots = 2 * contacts + worlds * kScanRun;
  own.slot.resize(contacts);
  own.body.resize(slots);
  own.wrench.resize(slots);
  own.slots_of_world.resize(worlds);
  own.first_slot.resize(worlds + 1);
  own.shift.resize(worlds);
  own.tile_measures.resize(tiles);
  own.body_tile_measures.resize(std::size_t(s.world_of_body_tile.size()));
  own.contacts_of_lane.resize(worlds * kSumLanes);
  own.bodies_of_lane.resize(worlds * kSumLanes);
  own.motor_before.resize(std::size_t(s.mechanisms.motor.size()));
  if (settings.tolerance <= 0) return;
  own.residual_square.resize(contacts);
  own.tile_residual.resize(tiles);
  own.residual_of_lane.resize(worlds * kSumLanes);
}

/// From the warm start in the step's contact store to the velocities and impulses at the end of the step. Call
/// reserve_scan before.
template <class Exec>
void solve_by_scan(Exec exec, State<Exec>& s, ScanStorage<Exec>& own, const StepSettings& settings) {
  GONOGO_ASSERT(own.slot.size() == s.contact_capacity && own.wrench.size() == own.body.size());
  GONOGO_ASSERT(own.first_slot.size() == s.world_count + 1 && settings.iterations >= 1);
  ScanIteration<Exec> iteration(exec, s, own, settings);
  iteration.begin();
  iteration.move(true);
  const std::int64_t max = std::int64_t(settings.substeps) * settings.iterations;
  for (std::int64_t k = 0; k < max && !seen_to_end(s); ++k) {
    iteration.update();
    iteration.move(false);
    iteration.carry();
    iteration.decide();
  }
  iteration.measure();
}

/// Bytes of an update if each record is moved once. A contact: its record, its impulse read and written, and two
/// wrenches written, then read and written by the scan. A body: mass, range of slots, last wrench and four velocities.
template <class Exec>
double scan_traffic(const State<Exec>& s, Index contacts) {
  constexpr double of_contact =
      sizeof(Contact) + 2 * sizeof(Impulse) + sizeof(SlotPair) + 2 * (3 * sizeof(Wrench) + sizeof(BodyIndex));
  constexpr double of_body = sizeof(BodyMass) + 4 * sizeof(Index) + sizeof(Wrench) + 4 * sizeof(Velocity);
  return double(contacts) * of_contact + double(s.body_count) * of_body;
}

}  // namespace gonogo::sim
