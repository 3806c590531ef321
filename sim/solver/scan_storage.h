// Storage of jacobi_scan; see jacobi_scan.h.
#pragma once
#include "sim/state/state.h"

namespace gonogo::sim {

/// Slots of a contact's two wrenches; b is -1 for a fixed body b.
struct alignas(8) SlotPair {
  Index a, b;
};

/// Slots are in the order of the bodies: for each the contacts it owns, then those where it is body b. Each world
/// starts a new run of the scan, so that its sums do not depend on the other worlds.
template <class Exec>
struct ScanStorage {
  Buffer<SlotPair, Exec> slot;                     // [contact]
  Buffer<BodyIndex, Exec> body;                    // [slot]
  Buffer<Wrench, Exec> wrench;                     // [slot] then scanned
  Buffer<Index, Exec> slots_of_world, first_slot;  // [world] whole runs, [world + 1]
  Buffer<Index, Exec> shift;                       // [world] see SlotsOfBody
  ScanScratch<Exec> scratch;
  Buffer<Real, Exec> residual_square;                         // [contact] of an update that tests [m^2/s^2]
  Buffer<double, Exec> tile_residual, residual_of_lane;       // [tile], [world * kSumLanes]
  Buffer<WorldSums, Exec> tile_measures, body_tile_measures;  // [tile], [body tile]
  Buffer<WorldSums, Exec> contacts_of_lane, bodies_of_lane;   // [world * kSumLanes]
  Buffer<Real, Exec> motor_before;                            // [motor]
};

}  // namespace gonogo::sim
