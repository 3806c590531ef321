// Fixed scenes, timed.
#pragma once
#include <filesystem>

#include "sim/simulation.h"

namespace gonogo::pipeline {

struct BedBench {
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  double grain_diameter = 0.05;  // of a bed 4 x 0.8 x 0.3 m [m]
  int iterations = 50;           // per step, all of them taken
  int steps = 21;                // timed one by one
  std::filesystem::path packing_folder;
};

struct BedBenchResult {
  Index bodies = 0, contacts = 0;
  int iterations = 0;
  double ns_per_contact_iteration = 0;  // whole step over contacts times iterations, median: search and set-up included
  double ms_per_step = 0;               // median
  double residual_m_per_s = 0;          // root mean square after the last step
};

/// A settled bed at rest under its own weight: friction 0.6, rolling 0.1, step 1e-3 s.
BedBenchResult bench_bed(const BedBench& request);

}  // namespace gonogo::pipeline
