// A tank full of spheres, made in seconds for any number of them: a block of spheres is settled once between periodic
// sides, many of it are laid side by side, and walls are put around them.
#pragma once
#include "sim/simulation.h"

namespace gonogo::pipeline {

struct TankSpec {
  Index spheres = 100'000;    // exactly so many
  double diameter = 0.04;     // mean [m]
  double size_spread = 0.05;  // radii are uniform in mean * (1 +- spread), so that no crystal forms
  double density = 2600;      // of the solid [kg/m^3]
  double friction = 0.3;      // among spheres and of the walls [-]
  int layers = 50;            // of spheres, fewer where there are few: the tank's depth does not grow with its floor
  std::uint64_t seed = 1;
};

/// Numerical parameters for spheres of this diameter; step 2e-3 s.
sim::StepSettings tank_step_settings(const TankSpec& spec, int iterations);

/// Bodies 0 .. spheres - 1 are the spheres, the next one is the tank: a floor at z = 0 and four walls, planes of one
/// fixed body. The surface is flat but for spheres taken off the top to leave the number that was asked for. Spheres
/// beside a wall have up to a radius of room from it until the first steps have been taken. Settled on `backend`.
/// Throws DeviceError when settling failed.
sim::SceneWorld tank_world(const TankSpec& spec, sim::Backend backend, int threads);

}  // namespace gonogo::pipeline
