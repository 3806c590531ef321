// Shapes of grains: a sphere, or a clump of equal overlapping spheres (lobes) on one rigid body. Clumps roll less than
// spheres and interlock, so that beds of clumps are stronger.
#pragma once
#include <string>
#include <vector>

#include "sim/scene/scene.h"

namespace gonogo::terrain {

/// pair: two lobes, centres one lobe radius apart. trefoil: three lobes at the corners of a triangle with sides of
/// sqrt(3) lobe radii. All three meet in one point only, so that overlaps are those of pairs.
enum class GrainShape : int { sphere, pair, trefoil };

/// Names, in the order of the enumeration.
const std::vector<std::string>& grain_shape_names();
const std::string& name_of(GrainShape shape);
/// Throws InputError that lists the names.
GrainShape grain_shape_of(const std::string& name);

/// A grain of uniform density. Origin: centre of mass; axes: principal axes.
struct Clump {
  std::vector<Vec3d> lobe;  // centres [m]
  double lobe_radius;       // [m]
  double volume;            // of the union of the lobes [m^3]
  Vec3d inertia_per_mass;   // principal moments of the union over its mass [m^2]
  double reach;             // radius of the sphere about the centre of mass that holds all lobes [m]
};

/// The clump whose volume is that of a sphere of this radius [m].
Clump clump_of(GrainShape shape, double radius);

/// One grain of a packing. Its shape is that of the packing.
struct Grain {
  Vec3d position;         // of the centre of mass [m]
  double radius;          // of the sphere with its volume [m]
  Quat orientation = {};  // of a clump, from its principal axes to the world; unused for spheres
};

/// Adds the grain as a body with one shape per lobe; returns the body's index.
sim::BodyIndex add_grain(sim::SceneWorld& world, GrainShape shape, const Grain& grain, double density, int material);

/// All lobes as spheres, grain by grain. Spheres are returned unchanged.
std::vector<Grain> lobes_of(GrainShape shape, const std::vector<Grain>& grains);

/// Copies the positions of the first bodies to the grains; for clumps also the orientations.
void take_places(std::vector<Grain>& grains, GrainShape shape, const std::vector<sim::BodyState>& bodies);

/// Orientation of the mirror image in y of a grain turned by q. Lobes lie in their body's plane z = 0, so the body is
/// its own mirror image in that plane. The image of the body turned by R is therefore the body turned by S R T, a
/// rotation, with the mirrors S = diag(1, -1, 1) and T = diag(1, 1, -1).
Quat mirrored(GrainShape shape, const Quat& q);

/// Orientation from three numbers in [0, 1). Uniform numbers give uniform rotations (Shoemake, Graphics Gems III (1992)
/// 124-132).
Quat random_orientation(double u, double v, double w);

}  // namespace gonogo::terrain
