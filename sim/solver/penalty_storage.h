// Storage of the penalty family; see penalty_method.h.
#pragma once
#include "sim/state/state.h"

namespace gonogo::sim {

template <class Exec>
struct PenaltyStorage {
  Buffer<Wrench, Exec> wrench_a, wrench_b;                       // [contact] on body a; [slot] on body b
  Buffer<WorldSums, Exec> body_tile_measures, measures_of_lane;  // [body tile], [world * kSumLanes]
};

}  // namespace gonogo::sim
