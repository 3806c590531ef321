// Views of the State's and the solver's arrays that the solver's kernel gets, in groups.
#pragma once
#include "sim/constraint/project_joints.h"
#include "sim/solver/cuda/records.cuh"
#include "sim/solver/shared_stages.h"
#include "sim/solver/split.h"
#include "sim/state/contact_lists.h"
#include "sim/state/mechanism.h"

namespace gonogo::sim {

/// The step and its problem.
struct StepViews {
  Tiles tiles;
  Incidence incidence;
  SplitMasses split;
  StepSettings settings;
  IterationRules rules;
  const Index* halted;
  const Index* contact_total;
};

/// Arrays of the State. The solver writes the contacts' step sizes and gaps, the impulses, the velocities and the sums.
struct StateViews {
  View<Contact> contact;
  View<const Index> second_slot;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const SymMat3> inverse_inertia_W;
  View<const Velocity> velocity_change;
  View<const WorldIndex> world_of_body, world_of_body_tile;
  View<const Index> first_body_tile;
  View<Velocity> free_velocity, velocity, extrapolated_velocity, substep_velocity, earlier_velocity;
  View<Impulse> impulse;  // warm start, and the result
  View<WorldSums> world_sums;
};

struct MechanismViews {
  Projection projection;
  MotorMoment motor_moment;
  Index mechanism_teams;               // the last ones, which move no other bodies than their mechanism's
  View<Velocity> gathered;             // [mechanism body], as are the next two
  View<MechanismSlot> mechanism_slot;  // of mechanisms too large for shared memory
  View<Velocity> mechanism_gathered;
  View<const Motor> motor;
  View<const MotorDrive> drive;
  View<Real> motor_impulse, motor_before;
};

/// Records of contacts and bodies; see SolverStorage.
struct RecordViews {
  View<FrameRecord> frame;
  View<ConeRecord> cone;
  View<TurnRecord> turn;
  View<CentralArms> central;
  View<ArmsRecord> arms;
  View<PairRecord> pair;
  View<GapRecord> gap;
  View<Vec3> linear[2], angular[2];
  View<HalfContact> half;
  View<HalfRange> of_body;
  View<BodyIndex> hub;
};

/// Counters and sums of an update, and the state of each world's iteration.
struct IterationViews {
  unsigned long long* barrier;
  Index* hub_count;
  View<Momentum> momentum[2];  // [world] of the present update and of the next, alternating
  View<UpdateSums> tile_sums;
  View<WorldSums> tile_measures, body_tile_measures;
};

/// Arrays of single methods; empty for the others.
struct MethodViews {
  View<Index> colour;
  Index* colours;  // how many
  View<Velocity> velocity_before;
  View<SpectralStep> length;
  View<SpectralSums> spectral_sums;
};

struct SolveViews : StepViews, StateViews, MechanismViews, RecordViews, IterationViews, MethodViews {};

inline StepViews step_views(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  return {.tiles = tiles(s),
          .incidence = incidence(s),
          .split = mass_splitting(s, settings),
          .settings = settings,
          .rules = settings.rules(),
          .halted = exec.halted,
          .contact_total = contact_count(s).count};
}

inline StateViews state_views(State<Cuda>& s) {
  return {.contact = s.contact.view(),
          .second_slot = s.second_slot.view(),
          .mass = s.mass.view(),
          .orientation = s.orientation.view(),
          .inverse_inertia_W = s.inverse_inertia_W.view(),
          .velocity_change = s.velocity_change.view(),
          .world_of_body = s.world_of_body.view(),
          .world_of_body_tile = s.world_of_body_tile.view(),
          .first_body_tile = s.first_body_tile.view(),
          .free_velocity = s.free_velocity.view(),
          .velocity = s.velocity.view(),
          .extrapolated_velocity = s.extrapolated_velocity.view(),
          .substep_velocity = s.substep_velocity.view(),
          .earlier_velocity = s.earlier_velocity.view(),
          .impulse = s.store[s.parity].impulse.view(),
          .world_sums = s.world_sums.view()};
}

inline MechanismViews mechanism_views(MechanismStore<Cuda>& m, SolverStorage<Cuda>& own, Index mechanism_teams) {
  return {.projection = projection(m),
          .motor_moment = motor_moment(m),
          .mechanism_teams = mechanism_teams,
          .gathered = m.gathered.view(),
          .mechanism_slot = own.mechanism_slot.view(),
          .mechanism_gathered = own.mechanism_gathered.view(),
          .motor = m.motor.view(),
          .drive = m.drive.view(),
          .motor_impulse = m.motor_impulse.view(),
          .motor_before = own.motor_before.view()};
}

inline RecordViews record_views(SolverStorage<Cuda>& own) {
  return {.frame = own.frame.view(),
          .cone = own.cone.view(),
          .turn = own.turn.view(),
          .central = own.central.view(),
          .arms = own.arms.view(),
          .pair = own.pair.view(),
          .gap = own.gap.view(),
          .linear = {own.linear[0].view(), own.linear[1].view()},
          .angular = {own.angular[0].view(), own.angular[1].view()},
          .half = own.half.view(),
          .of_body = own.of_body.view(),
          .hub = own.hub.view()};
}

inline IterationViews iteration_views(State<Cuda>& s, SolverStorage<Cuda>& own) {
  return {.barrier = own.counter.data(),
          .hub_count = reinterpret_cast<Index*>(own.counter.data() + 1),
          .momentum = {s.momentum.view(), own.other_momentum.view()},
          .tile_sums = own.tile_sums.view(),
          .tile_measures = own.tile_measures.view(),
          .body_tile_measures = own.body_tile_measures.view()};
}

inline MethodViews method_views(SolverStorage<Cuda>& own) {
  return {.colour = own.colour.view(),
          .colours = reinterpret_cast<Index*>(own.counter.data() + 2),
          .velocity_before = own.velocity_before.view(),
          .length = own.length.view(),
          .spectral_sums = own.spectral_sums.view()};
}

/// Starts body b and returns its velocity without impulses.
GONOGO_DEVICE Velocity begin_body(const SolveViews& s, BodyIndex b) {
  return begin_body(s.velocity[b], s.velocity_change[b], s.free_velocity[b], s.earlier_velocity[b]);
}

/// Carries body b, which has moved with `v`, into the next substep. `free`: in and out. See shared_stages.h.
GONOGO_DEVICE Velocity carry_body(const SolveViews& s, BodyIndex b, const Velocity& v, Velocity& free) {
  const Velocity more = carry_body(v, s.velocity_change[b], free, s.substep_velocity[b], s.earlier_velocity[b]);
  s.free_velocity[b] = free;
  return more;
}

/// Velocity of body b by these sums of impulses. `free`, `m`: of body b, already loaded.
GONOGO_DEVICE Velocity driven(const SolveViews& s, BodyIndex b, const Velocity& free, const BodyMass& m,
                              const Vec3& linear, const Vec3& angular) {
  const SymMat3 inverse_inertia = m.isotropic ? SymMat3{} : s.inverse_inertia_W[b];
  return driven_velocity(free, m, inverse_inertia, linear, angular);
}

}  // namespace gonogo::sim
