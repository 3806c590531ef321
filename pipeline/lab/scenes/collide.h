// The search for contacts by itself.
#pragma once
#include "pipeline/lab/scenes/tank.h"

namespace gonogo::lab {

struct CollideBench {
  TankSpec tank;
  RunOn on;  // without iterations
  int repeats = 11;
};

struct CollideBenchResult {
  std::int64_t bodies = 0, contacts = 0;
  double build_seconds = 0;   // of settling, laying out and the first search
  double ms_per_search = 0;   // median of bins and contacts
  sim::StageTimes stages;     // medians
  double ns_per_contact = 0;  // of the search
};

/// Finds the contacts of the tank at rest `repeats` times: bins, pairs, gaps, normals and points. Takes no step.
CollideBenchResult bench_collide(const CollideBench& request);

}  // namespace gonogo::lab
