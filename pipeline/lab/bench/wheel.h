// The wheel scene: a driven tyre on a bed of grains up a slope, timed and measured.
#pragma once
#include <filesystem>

#include "sim/simulation/simulation.h"

namespace gonogo::lab {

struct WheelBench {
  std::filesystem::path scene = "configs/scenes/wheel.json";
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  sim::Solver solver = sim::Solver::apgd;
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
