// Storage of the solver on the GPU. Records are packed for bandwidth: an arm along the normal (two spheres, a sphere on
// a fixed floor) is one number.
#pragma once
#include "sim/solver/cuda/team.cuh"
#include "sim/solver/jacobi_scan.h"
#include "sim/solver/penalty_method.h"
#include "sim/solver/solve.h"
#include "sim/solver/spectral.h"

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

/// Bytes of one update of a contact if each record is moved once: its own records, its present, previous and next
/// impulse, and both of its halves with the impulse for the bodies' sums.
constexpr double bytes_per_contact(bool turning) {
  const double own = sizeof(FrameRecord) + sizeof(ConeRecord) + sizeof(CentralArms) + sizeof(PairRecord) +
                     (turning ? sizeof(TurnRecord) : 0);
  const double impulse = sizeof(Vec3) * (turning ? 2 : 1);
  return own + 3 * impulse + 2 * (sizeof(HalfContact) + impulse);
}
/// Bytes of one update of a body: mass, range of halves and five velocities. Read: free and present; written: present
/// and extrapolated; the contacts read the extrapolated one again.
constexpr double bytes_per_body() { return sizeof(BodyMass) + sizeof(HalfRange) + 5 * sizeof(Velocity); }

// Records that a block holds in shared memory through all iterations of a step. Used where every tile has a team and
// every body its threads; then an iteration reads little more than velocities and impulses from memory. The rest is
// left to the cache, which shares the multiprocessor's memory.

/// Threads that share a body's contacts.
inline constexpr Index kLanesPerBody = 4;
/// Half contacts of a body that a thread holds; it reads the others from memory in every iteration.
inline constexpr Index kHeldHalves = 2;

/// Numbers of a mechanism's affine map that a team holds: enough for nine bodies, a truck with its wheels and axles.
inline constexpr Index kHeldProjection = 55 * 56;

/// Records of one contact and of half contacts per thread, the bodies of the lanes (world -1: other threads move the
/// body), and the map of one mechanism, which the block's last team moves.
struct Residence {
  FrameRecord frame[kBlockSize];
  ConeRecord cone[kBlockSize];
  TurnRecord turn[kBlockSize];
  HalfContact half[kHeldHalves][kBlockSize];
  CentralArms central[kBlockSize];
  PairRecord pair[kBlockSize];
  ArmsRecord arms[kBlockSize];
  Vec3 linear[2][kBlockSize], angular[2][kBlockSize];
  HalfRange contacts_of_body[kBlockSize / kLanesPerBody];
  WorldIndex world_of_body[kBlockSize / kLanesPerBody];
  Tile tile[kTeamsPerBlock];
  Index hub_count;
  Real projection[kHeldProjection];
};

GONOGO_DEVICE Residence& residence() {
  extern __shared__ __align__(16) std::uint8_t residence_bytes[];
  return *reinterpret_cast<Residence*>(residence_bytes);
}

}  // namespace gonogo::sim
