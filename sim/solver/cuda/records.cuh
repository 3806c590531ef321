// Storage of the solver on the GPU. Records are packed for bandwidth: an arm along the normal (two spheres, a sphere on
// a fixed floor) is one number.
#pragma once
#include "sim/solver/penalty_storage.h"
#include "sim/solver/scan_storage.h"
#include "sim/solver/spectral.h"
#include "sim/solver/storage.h"

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
/// Arms along the normal [m]. `a` is NaN where they are not along it: then ArmsRecord holds them.
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
/// A contact as one of its bodies sees it. Those of a body are contiguous, owned ones first.
struct alignas(16) HalfContact {
  Vec3 arm;
  Index contact;  // ~contact where the opposite impulse acts
};
struct alignas(8) HalfRange {
  Index begin, end;
};

/// A body of a mechanism while its velocity is computed.
struct MechanismSlot {
  BodyIndex body;
  HalfRange contacts;
  Vec3 linear, angular;  // sums over contacts
  Real ahead[6];         // last extrapolation of its velocities
};

template <>
struct SolverStorage<Cuda> {
  Buffer<FrameRecord, Cuda> frame;  // [contact], as are the next eight
  Buffer<ConeRecord, Cuda> cone;
  Buffer<TurnRecord, Cuda> turn;
  Buffer<CentralArms, Cuda> central;
  Buffer<ArmsRecord, Cuda> arms;
  Buffer<PairRecord, Cuda> pair;
  Buffer<GapRecord, Cuda> gap;               // where a step has substeps
  Buffer<Vec3, Cuda> linear[2], angular[2];  // impulses of the latest two updates, alternating
  Buffer<HalfContact, Cuda> half;            // [contact * 2]
  Buffer<HalfRange, Cuda> of_body;           // into half
  Buffer<BodyIndex, Cuda> hub;               // bodies with more than kHubContacts contacts
  Buffer<unsigned long long, Cuda> counter;  // of the barrier, of hubs and of colours
  Buffer<UpdateSums, Cuda> tile_sums;
  Buffer<WorldSums, Cuda> tile_measures, body_tile_measures;
  Buffer<Momentum, Cuda> other_momentum;  // [world]
  Buffer<Real, Cuda> motor_before;
  Buffer<MechanismSlot, Cuda> mechanism_slot;  // [mechanism body], as is the next
  Buffer<Velocity, Cuda> mechanism_gathered;   // with the free motion of the next substep
  Buffer<Index, Cuda> colour;                  // [contact] for Gauss-Seidel
  Buffer<Velocity, Cuda> velocity_before;      // [body] of the update before, for spectral gradients
  Buffer<SpectralStep, Cuda> length;           // [world]
  Buffer<SpectralSums, Cuda> spectral_sums;
  ScanStorage<Cuda> scan;
  PenaltyStorage<Cuda> penalty;
};

}  // namespace gonogo::sim
