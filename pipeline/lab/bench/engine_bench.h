// The engine timed: a settled bed at rest, alone or many times over in one batch, and a driven wheel on a bed.
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

// The wheel scene: a driven tyre on a bed of grains up a slope, timed and measured.

struct WheelBench {
  std::filesystem::path scene = "configs/scenes/wheel.json";
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  sim::ContactMethod solver{};
  sim::Target target = sim::Target::ccp;
  double step = 1e-3;     // [s]; 0 with penalty contact: nine tenths of the critical step
  int substeps = 14;      // per step; with two iterations each the cheapest of the table in docs/benchmarks that
                          // holds the slip
  int iterations = 2;     // most per substep
  double tolerance = 0;   // [m/s]
  double overlap = 0.02;  // penalty contact, see terrain::Numerics
  int worlds = 1;         // in one batch; their wheels start at different places of the same bed
  double drive_time = 0;  // instead of the scene's, where above zero [s]
  std::filesystem::path packing_folder;
};

struct WheelBenchResult {
  Index bodies = 0;    // of one world
  Index contacts = 0;  // of all worlds at the end
  Index steps = 0;
  double step = 0;  // [s]
  double mean_iterations = 0;
  double ms_per_step = 0;         // mean over the drive; all worlds together
  double simulated_per_wall = 0;  // simulated seconds of one world per wall second
  double start_up = 0;            // from the call to the first step taken, packing excluded [s]
  double slip = 0;                // over the last half of the drive, mean over the worlds [-]
  double slip_error = 0;          // standard error of that mean; 0 for one world [-]
  double sinkage = 0;             // mean over the last half of the drive [m]
  double torque = 0;              // of the motor, mean over the last half of the drive [N m]
  double residual_rms = 0;        // mean over the drive [m/s]
  double residual_max = 0;        // largest seen [m/s]
  sim::Fault fault;               // the first one of a world that failed
};

/// Reads the scene, settles the tilted bed, lets the wheel down, ramps its speed up and drives.
/// Throws InputError for a bad scene file and DeviceError when the run raises a flag.
WheelBenchResult bench_wheel(WheelBench request);

}  // namespace gonogo::lab
