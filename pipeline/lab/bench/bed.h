// A settled bed at rest, alone or many times over in one batch, timed.
#pragma once
#include <filesystem>

#include "sim/simulation/simulation.h"

namespace gonogo::lab {

struct BedBench {
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  double grain_diameter = 0.05;                 // [m]
  double length = 4, width = 0.8, depth = 0.3;  // of one bed [m]
  int copies = 1;                               // of the bed laid side by side along x into one world
  int worlds = 1;                               // of that world in the batch
  int iterations = 50;                          // per step, all of them taken
  int repeats = 11;                             // timed samples
  int steps_per_sample = 4;
  double friction = 0.6, rolling_friction = 0.1;
  std::filesystem::path packing_folder;
};

struct BedBenchResult {
  Index worlds = 0;
  std::int64_t bodies = 0, contacts = 0;  // of the whole batch
  int iterations = 0;
  double ms_per_step = 0;                      // median
  double ns_per_contact_iteration = 0;         // whole step over contacts times iterations: search included
  double ns_per_contact_iteration_solver = 0;  // one more iteration of one contact: from two iteration counts
  double residual_m_per_s = 0;                 // root mean square in the first world after the last step
};

/// The bed rests under its own weight; step 1e-3 s. All worlds of the batch are equal.
BedBenchResult bench_bed(const BedBench& request);

}  // namespace gonogo::lab
