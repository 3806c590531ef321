// What the solver on the GPU keeps for itself, and how much of it. Records are packed for bandwidth: an arm along the
// normal (two spheres, a sphere on a fixed floor) is one number. On any execution space, so that the host can tell how
// many bytes it takes.
#pragma once
#include "sim/solver/jacobi_scan.h"
#include "sim/solver/penalty_method.h"
#include "sim/solver/spectral.h"
#include "sim/state/contact_lists.h"
#include "sim/state/state.h"

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

/// Of a solver that keeps all threads of a grid busy: the GPU's.
template <class Exec>
struct GridStorage {
  Buffer<FrameRecord, Exec> frame;  // [contact], as are the next eight
  Buffer<ConeRecord, Exec> cone;
  Buffer<TurnRecord, Exec> turn;
  Buffer<CentralArms, Exec> central;
  Buffer<ArmsRecord, Exec> arms;
  Buffer<PairRecord, Exec> pair;
  Buffer<GapRecord, Exec> gap;               // where a step has substeps
  Buffer<Vec3, Exec> linear[2], angular[2];  // impulses of the latest two updates, alternating
  Buffer<HalfContact, Exec> half;            // [contact * 2]
  Buffer<HalfRange, Exec> of_body;           // into half
  Buffer<BodyIndex, Exec> hub;               // bodies with more than kHubContacts contacts
  Buffer<unsigned long long, Exec> counter;  // of the barrier, of hubs and of colours
  Buffer<UpdateSums, Exec> tile_sums;
  Buffer<WorldSums, Exec> tile_measures, body_tile_measures;
  Buffer<Momentum, Exec> other_momentum;  // [world]
  Buffer<Real, Exec> motor_before;
  Buffer<MechanismSlot, Exec> mechanism_slot;  // [mechanism body], as is the next
  Buffer<Velocity, Exec> mechanism_gathered;   // with the free motion of the next substep
  Buffer<Index, Exec> colour;                  // [contact] for Gauss-Seidel
  Buffer<Velocity, Exec> velocity_before;      // [body] of the update before, for spectral gradients
  Buffer<SpectralStep, Exec> length;           // [world]
  Buffer<SpectralSums, Exec> spectral_sums;
  ScanStorage<Exec> scan;
  PenaltyStorage<Exec> penalty;
};

inline bool is_accelerated(Iteration iteration) {
  return iteration == Iteration::apgd || iteration == Iteration::jacobi;
}

/// Sizes the buffers for the present capacity.
template <class Exec>
void reserve_grid(const State<Exec>& s, GridStorage<Exec>& own, const StepSettings& settings) {
  if (is_penalty(settings.contact)) return reserve_penalty(s, own.penalty);
  if (settings.iteration == Iteration::jacobi_scan) return reserve_scan(s, own.scan, settings);
  own.frame.resize(s.contact_capacity);
  own.cone.resize(s.contact_capacity);
  own.central.resize(s.contact_capacity);
  own.arms.resize(s.contact_capacity);
  own.pair.resize(s.contact_capacity);
  if (settings.substeps > 1 || !is_accelerated(settings.iteration)) own.gap.resize(s.contact_capacity);
  for (auto& of_contact : own.linear) of_contact.resize(s.contact_capacity);
  if (s.turning || !is_accelerated(settings.iteration)) {
    own.turn.resize(s.contact_capacity);
    for (auto& of_contact : own.angular) of_contact.resize(s.contact_capacity);
  }
  own.half.resize(2 * std::size_t(s.contact_capacity));
  own.of_body.resize(s.body_count);
  own.hub.resize(s.body_count);
  own.counter.resize(3);
  own.tile_sums.resize(tile_capacity(s));
  own.tile_measures.resize(tile_capacity(s));
  own.body_tile_measures.resize(s.world_of_body_tile.size());
  own.other_momentum.resize(s.world_count);
  own.motor_before.resize(s.mechanisms.motor.size());
  own.mechanism_slot.resize(s.mechanisms.gathered.size());
  own.mechanism_gathered.resize(s.mechanisms.gathered.size());
  if (settings.iteration == Iteration::gauss_seidel) own.colour.resize(s.contact_capacity);
  if (settings.iteration != Iteration::bb) return;
  own.velocity_before.resize(s.body_count);
  own.length.resize(s.world_count);
  own.spectral_sums.resize(tile_capacity(s));
}

}  // namespace gonogo::sim
