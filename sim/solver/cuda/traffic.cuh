// How much memory an update moves: a yardstick for benchmarks.
#pragma once
#include "sim/solver/cuda/records.cuh"

namespace gonogo::sim {

/// What one update of a contact moves when each record is moved once: the contact's own, its impulses of now, before
/// and next, and both of its halves with the impulse as the bodies sum it.
constexpr double bytes_per_contact(bool turning) {
  const double own = sizeof(FrameRecord) + sizeof(ConeRecord) + sizeof(CentralArms) + sizeof(PairRecord) +
                     (turning ? sizeof(TurnRecord) : 0);
  const double impulse = sizeof(Vec3) * (turning ? 2 : 1);
  return own + 3 * impulse + 2 * (sizeof(HalfContact) + impulse);
}
/// And of a body: mass, range of halves, velocities without impulses and of now, and those of now and ahead written;
/// what is ahead is read again by the contacts.
constexpr double bytes_per_body() { return sizeof(BodyMass) + sizeof(HalfRange) + 5 * sizeof(Velocity); }

}  // namespace gonogo::sim
