// Memory traffic of an update, for benchmarks.
#pragma once
#include "sim/solver/cuda/records.cuh"

namespace gonogo::sim {

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

}  // namespace gonogo::sim
