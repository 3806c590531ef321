// The shaken tank: up to millions of spheres, timed stage by stage.
#pragma once
#include "pipeline/bench/tank_scene.h"
#include "sim/stages.h"

namespace gonogo::pipeline {

struct TankBench {
  TankSpec tank;
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  int iterations = 50;  // per step, all of them taken
  int warm_up = 60;     // steps of shaking before the first timed one, in which the spheres meet the walls
  int repeats = 11;     // timed samples
  int steps_per_sample = 4;
};

struct TankBenchResult {
  std::int64_t bodies = 0, contacts = 0;
  double build_seconds = 0;                    // of settling, laying out and the first step
  double ms_per_step = 0;                      // median, stages queued as in any run
  sim::StageTimes stages;                      // medians of steps taken stage by stage
  double ns_per_contact_iteration = 0;         // whole step over contacts times iterations
  double ns_per_contact_iteration_solver = 0;  // the solver's stage over contacts times iterations
  double residual_m_per_s = 0;                 // root mean square after the last step
  double copy_bandwidth = 0;                   // [B/s]
  std::optional<double> bandwidth_share;       // what the solver moves over what a copy would move meanwhile
};

/// The tank is shaken along x with half of gravity, two times a second; it is watched from inside of it, so gravity
/// leans to and fro.
TankBenchResult bench_tank(const TankBench& request);

struct CollideBench {
  TankSpec tank;
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  int repeats = 11;
};

struct CollideBenchResult {
  std::int64_t bodies = 0, contacts = 0;
  double build_seconds = 0;   // of settling, laying out and the first search
  double ms_per_search = 0;   // median of bins and contacts
  sim::StageTimes stages;     // medians
  double ns_per_contact = 0;  // of the search
};

/// Finds the contacts of the same tank again and again: bins, pairs, gaps, normals and points. No step is taken.
CollideBenchResult bench_collide(const CollideBench& request);

}  // namespace gonogo::pipeline
