// Memory traffic of an update on the host, for benchmarks. For the GPU see cuda/traffic.cuh.
#pragma once
#include "sim/solver/host_blocks.h"

namespace gonogo::sim {

/// Bytes of one update of a contact if each record is moved once: its lane of a block read, one of the block's two
/// impulses written, and both wrenches written and then read by the bodies' sums.
constexpr double host_bytes_per_contact() {
  return double(sizeof(ContactBlock) + sizeof(ImpulseT<Pack>)) / kPackWidth + 4 * sizeof(Wrench);
}
/// Bytes of one update of a body: mass, ranges of its contacts and five velocities. Read: free and present; written:
/// present and extrapolated; the contacts read the extrapolated one again.
constexpr double host_bytes_per_body() { return sizeof(BodyMass) + 4 * sizeof(Index) + 5 * sizeof(Velocity); }

}  // namespace gonogo::sim
