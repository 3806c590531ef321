// Storage of the solver on the GPU, and the records that a block holds through a step.
#pragma once
#include "sim/solver/cuda/team.cuh"
#include "sim/solver/grid_storage.h"
#include "sim/solver/solve.h"

namespace gonogo::sim {

template <>
struct SolverStorage<Cuda> : GridStorage<Cuda> {};

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
