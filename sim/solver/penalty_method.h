// The penalty family as a stage of the step, on either backend. Forces follow from the overlaps and velocities at the
// step's start, velocities from the forces, positions from the new velocities (symplectic Euler, the leapfrog with
// velocities given half a step early). Nothing is iterated but the motors. sim/scene/critical_step.h bounds the step.
#pragma once
#include "sim/solver/penalty_stages.h"
#include "sim/solver/penalty_storage.h"
#include "sim/solver/scan_stages.h"

namespace gonogo::sim {

template <class Exec>
void reserve_penalty(const State<Exec>& s, PenaltyStorage<Exec>& own) {
  own.wrench_a.resize(std::size_t(s.contact_capacity));
  own.wrench_b.resize(std::size_t(s.contact_capacity));
  own.body_tile_measures.resize(std::size_t(s.world_of_body_tile.size()));
  own.measures_of_lane.resize(std::size_t(s.world_count) * kSumLanes);
}

template <class Exec>
PushContact contact_push(State<Exec>& s, PenaltyStorage<Exec>& own, const StepSettings& settings) {
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
          .step = settings.step,
          .hertz = settings.solver == Solver::hertz};
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
  for_each_index(exec, s.world_of_body_tile.size(),
                 MeasureBodyTile{.world = s.world.view(),
                                 .first_body_tile = s.first_body_tile.view(),
                                 .world_of_body_tile = s.world_of_body_tile.view(),
                                 .mass = s.mass.view(),
                                 .orientation = s.orientation.view(),
                                 .velocity = s.velocity.view(),
                                 .sums = own.body_tile_measures.view()});
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
  for_each_counted(exec, contact_count(s), contact_push(s, own, settings));
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
