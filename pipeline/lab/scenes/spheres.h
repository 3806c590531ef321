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
  /// Columns of the lattice are so far apart that no two spheres overlap, wherever their draws put them [m].
  double pitch() const { return 1.01 * largest_diameter(); }
};

struct Sphere {
  Vec3d centre;   // [m]
  double radius;  // [m]
};

/// Spheres of a cubic lattice, each a little aside so that columns buckle, from the lower corner upward, x fastest;
/// only those whose place `inside` accepts, and no more than `max_count` of them.
std::vector<Sphere> loose_lattice(const Spheres& spec, const Vec3d& corner, Index nx, Index ny, Index nz,
                                  const std::function<bool(const Vec3d&)>& inside, std::size_t max_count);

/// Numerical parameters for spheres of this diameter; step 2e-3 s. The envelope gives about 3.6 contacts a sphere, as
/// the published tank has 3.55.
sim::StepSettings many_step_settings(const Spheres& spec, int iterations, sim::Solver solver = sim::Solver::apgd);

/// A plane of a body through `at` that looks along the z axis turned by `turn`.
void add_plane(sim::SceneWorld& world, sim::BodyIndex body, const Vec3d& at, const Quat& turn);

/// Turns the z axis, along which a plane looks, into x, -x (axis 0), y or -y (axis 1).
Quat towards(int axis, double sign);

/// Time in which something falls so deep [s].
double fall_time(double height);

/// Height of the highest point [m].
double height_of(const std::vector<Sphere>& spheres);

}  // namespace gonogo::lab
