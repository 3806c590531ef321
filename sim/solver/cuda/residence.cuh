// What a block holds on its multiprocessor through all iterations of a step, where every tile has a team and every body
// its threads: then an iteration reads little more than velocities and impulses from memory. What is not here is left
// to the cache, which shares the memory of the multiprocessor.
#pragma once
#include "sim/solver/cuda/records.cuh"
#include "sim/solver/cuda/team.cuh"

namespace gonogo::sim {

/// Threads that share a body's contacts.
inline constexpr Index kLanesPerBody = 4;
/// Half contacts of a body that a thread holds; it reads the others again in every iteration.
inline constexpr Index kHeldHalves = 2;

/// Numbers of a mechanism's affine map that a team holds: of nine bodies, a truck with its wheels and axles.
inline constexpr Index kHeldProjection = 55 * 56;

/// One of everything per thread, what its few threads need to know of a body (-1: others see to it), and the map of a
/// mechanism, which the block's last team moves.
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
