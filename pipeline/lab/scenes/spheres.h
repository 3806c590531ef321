// Spheres that do not touch yet, to be settled, and what the scenes of many spheres have in common.
#pragma once
#include <functional>
#include <vector>

#include "sim/simulation/simulation.h"

namespace gonogo::lab {

/// Spheres of the scenes of many bodies.
struct Spheres {
  Index count = 16'000;       // exactly so many
  double diameter = 0.04;     // mean [m]
  double size_spread = 0.05;  // radii are uniform in mean * (1 +- spread), so that no crystal forms
  double density = 2600;      // of the solid [kg/m^3]
  double friction = 0.3;      // among spheres and of walls [-]
  std::uint64_t seed = 1;

  double largest_diameter() const { return diameter * (1 + size_spread); }
  /// Distance of the lattice's columns: no two spheres overlap, whatever their draws [m].
  double pitch() const { return 1.01 * largest_diameter(); }
};

struct Sphere {
  Vec3d centre;   // [m]
  double radius;  // [m]
};

/// Spheres of a cubic lattice from the lower corner upward, x fastest, each shifted a little so that columns buckle.
/// Only places that `inside` accepts are taken, at most `max_count` of them.
std::vector<Sphere> loose_lattice(const Spheres& spec, const Vec3d& corner, Index nx, Index ny, Index nz,
                                  const std::function<bool(const Vec3d&)>& inside, std::size_t max_count);

/// Numerics for spheres of this diameter; step 2e-3 s. The envelope gives about 3.6 contacts per sphere; the published
/// tank has 3.55.
sim::StepSettings many_step_settings(const Spheres& spec, int iterations, sim::Solver solver = sim::Solver::apgd);

/// Adds a plane to a body, through `at`, with its normal along the z axis turned by `turn`.
void add_plane(sim::SceneWorld& world, sim::BodyIndex body, const Vec3d& at, const Quat& turn);

/// Turns the z axis, along which a plane looks, into x, -x (axis 0), y or -y (axis 1).
Quat towards(int axis, double sign);

/// Time of a fall from this height [s].
double fall_time(double height);

/// Height of the highest point [m].
double height_of(const std::vector<Sphere>& spheres);

}  // namespace gonogo::lab
