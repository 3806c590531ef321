// What the solver keeps on the GPU. Records are packed for bandwidth: an arm along the normal (two spheres, a sphere on
// a fixed floor) is one number.
#pragma once
#include "sim/joint/project.h"
#include "sim/solver/body_update.h"
#include "sim/solver/scan_storage.h"
#include "sim/solver/spectral.h"
#include "sim/solver/split.h"
#include "sim/solver/storage.h"
#include "sim/state/motor.h"
#include "sim/state/tiles.h"

namespace gonogo::sim {

struct alignas(16) FrameRecord {
  Vec3 normal;
  Real bias;
};
struct alignas(16) ConeRecord {
  Real step_n, step_t, mu, cohesion;
};
struct alignas(16) TurnRecord {
  Real rho, sigma, step_r, softness;
};
/// Arms along the normal [m]; not a number in `a` where they are not: then ArmsRecord holds them.
struct alignas(8) CentralArms {
  Real a, b;
};
struct ArmsRecord {
  Vec3 a, b;
};
struct alignas(8) GapRecord {
  Real gap, rate;  // see Contact
};
struct alignas(8) PairRecord {
  BodyIndex a, b;
};
/// A contact as one of its bodies sees it; those of a body follow each other, owned ones first.
struct alignas(16) HalfContact {
  Vec3 arm;
  Index contact;  // its complement where the impulse acts backwards
};
struct alignas(8) HalfRange {
  Index begin, end;
};

/// A body of a mechanism while its velocity is worked out.
struct MechanismSlot {
  BodyIndex body;
  HalfRange contacts;
  Vec3 linear, angular;  // sums over contacts
  Real ahead[6];         // by which its velocities were extrapolated last
};

template <>
struct SolverStorage<Cuda> {
  Buffer<FrameRecord, Cuda> frame;  // [contact], as are the next eight
  Buffer<ConeRecord, Cuda> cone;
  Buffer<TurnRecord, Cuda> turn;
  Buffer<CentralArms, Cuda> central;
  Buffer<ArmsRecord, Cuda> arms;
  Buffer<PairRecord, Cuda> pair;
  Buffer<GapRecord, Cuda> gap;               // where a step has parts
  Buffer<Vec3, Cuda> linear[2], angular[2];  // impulses of the latest two updates, taking turns
  Buffer<HalfContact, Cuda> half;            // [contact * 2]
  Buffer<HalfRange, Cuda> of_body;           // into half
  Buffer<BodyIndex, Cuda> hub;               // bodies with so many contacts that a warp sums them
  Buffer<unsigned long long, Cuda> counter;  // of the barrier, of hubs and of colours
  Buffer<UpdateSums, Cuda> tile_sums;
  Buffer<WorldSums, Cuda> tile_measures, body_tile_measures;
  Buffer<Momentum, Cuda> other_momentum;  // [world]
  Buffer<Real, Cuda> motor_before;
  Buffer<MechanismSlot, Cuda> mechanism_slot;  // [mechanism body], as is the next
  Buffer<Velocity, Cuda> mechanism_gathered;   // with the free motion of the next part
  Buffer<Index, Cuda> colour;                  // [contact] for Gauss-Seidel
  Buffer<Velocity, Cuda> velocity_before;      // [body] of the update before, for spectral gradients
  Buffer<SpectralStep, Cuda> length;           // [world]
  Buffer<SpectralSums, Cuda> spectral_sums;
  ScanStorage<Cuda> scan;
};

/// What the kernel works on.
struct SolveViews {
  Tiles tiles;
  Incidence incidence;
  SplitMasses split;
  StepSettings settings;
  IterationRules rules;
  const Index* halted;
  const Index* contact_total;
  View<Contact> contact;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const SymMat3> inverse_inertia_W;
  View<const Velocity> velocity_change;
  View<const WorldIndex> world_of_body, world_of_body_tile;
  View<const Index> first_body_tile;
  Projection projection;
  MotorMoment motor_moment;
  Index mechanism_teams;               // the last ones; they see to nothing but their mechanism while bodies move
  View<Velocity> gathered;             // [mechanism body], as are the next two
  View<MechanismSlot> mechanism_slot;  // of mechanisms too large for shared memory
  View<Velocity> mechanism_gathered;
  View<const Motor> motor;
  View<const MotorDrive> drive;
  View<Real> motor_impulse, motor_before;
  View<Velocity> free_velocity, velocity, extrapolated_velocity, part_velocity, earlier_velocity;
  View<Momentum> momentum[2];  // [world] of the present update and of the next, taking turns
  View<Impulse> impulse;       // warm start, and the result
  View<WorldSums> world_sums;

  View<FrameRecord> frame;
  View<ConeRecord> cone;
  View<TurnRecord> turn;
  View<CentralArms> central;
  View<ArmsRecord> arms;
  View<PairRecord> pair;
  View<GapRecord> gap;
  View<Vec3> linear[2], angular[2];
  View<const Index> second_slot;
  View<HalfContact> half;
  View<HalfRange> of_body;
  View<BodyIndex> hub;
  unsigned long long* barrier;
  Index* hub_count;
  View<UpdateSums> tile_sums;
  View<WorldSums> tile_measures, body_tile_measures;

  // Of the methods that use them; empty otherwise.
  View<Index> colour;
  Index* colours;  // how many
  View<Velocity> velocity_before;
  View<SpectralStep> length;
  View<SpectralSums> spectral_sums;
};

/// Body b at the beginning of the step: its velocity without impulses.
GONOGO_DEVICE Velocity begin_body(const SolveViews& s, BodyIndex b) {
  return begin_body(s.velocity[b], s.velocity_change[b], s.free_velocity[b], s.earlier_velocity[b]);
}

/// Body b has moved with `v`; `free`: at hand, and goes on. See carry_body in body_update.h.
GONOGO_DEVICE Velocity carry_body(const SolveViews& s, BodyIndex b, const Velocity& v, Velocity& free) {
  const Velocity more = carry_body(v, s.velocity_change[b], free, s.part_velocity[b], s.earlier_velocity[b]);
  s.free_velocity[b] = free;
  return more;
}

/// `free`, `m`: of body b, loaded early.
GONOGO_DEVICE Velocity driven(const SolveViews& s, BodyIndex b, const Velocity& free, const BodyMass& m,
                              const Vec3& linear, const Vec3& angular) {
  const SymMat3 inverse_inertia = m.isotropic ? SymMat3{} : s.inverse_inertia_W[b];
  return driven_velocity(free, m, inverse_inertia, linear, angular);
}

}  // namespace gonogo::sim
