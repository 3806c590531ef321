// `jacobi_scan`: the baseline to which the fast iterations are compared. It takes the steps of `jacobi`, but impulses
// reach the bodies as in the first solvers of this family on GPUs (Tasora & Negrut 2009; Negrut et al. 2012). Every
// contact writes its two wrenches into slots sorted by body, a segmented scan sums the slots of each body, then all
// bodies move. (In Chrono's code of 2012, src/unit_PARALLEL/ChLcpSolverGPU.cu, one thread per body sums its slots.)
// Those solvers added changes of velocity; here slots hold whole impulses, so that rounding does not accumulate. Each
// stage is a loop of its own, on either backend.
#pragma once
#include <type_traits>

#include "sim/solver/scan_stages.h"

namespace gonogo::sim {

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
    for_each_index(
        exec_, s.body_count,
        BeginBody{s.velocity.view(), s.velocity_change.view(), s.free_velocity.view(), s.earlier_velocity.view()});
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
    for_each_index(exec_, s.world_of_body_tile.size(),
                   MeasureBodyTile{.world = s.world.view(),
                                   .first_body_tile = s.first_body_tile.view(),
                                   .world_of_body_tile = s.world_of_body_tile.view(),
                                   .mass = s.mass.view(),
                                   .orientation = s.orientation.view(),
                                   .velocity = s.velocity.view(),
                                   .sums = own.body_tile_measures.view()});
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
