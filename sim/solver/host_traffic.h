// How much memory an update moves on the host: a yardstick for benchmarks; see cuda/traffic.cuh for the GPU.
#pragma once
#include "sim/solver/host_blocks.h"

namespace gonogo::sim {

/// What one update of a contact moves when each record is moved once: its lane of a block read, one of the block's two
/// impulses written, and both wrenches written and read by the bodies' sums.
constexpr double host_bytes_per_contact() {
  return double(sizeof(ContactBlock) + sizeof(ImpulseT<Pack>)) / kPackWidth + 4 * sizeof(Wrench);
}
/// And of a body: mass, ranges of its contacts, velocities without impulses and of now, and those of now and ahead
/// written; what is ahead is read again by the contacts.
constexpr double host_bytes_per_body() { return sizeof(BodyMass) + 4 * sizeof(Index) + 5 * sizeof(Velocity); }

}  // namespace gonogo::sim
