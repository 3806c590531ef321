// A solid mesh as a body of spheres. Host only.
#pragma once
#include "sim/scene/scene.h"
#include "sim/shape/sphere_cover.h"

namespace gonogo::sim {

/// Adds a body with the mass properties of the mesh as a solid of this density [kg/m^3], and the spheres of the cover
/// as its shapes. `at`: position and orientation of the mesh's axes, and velocity of its centre of mass. The body's
/// axes are its principal axes of inertia. Returns the body's index.
BodyIndex add_compound(SceneWorld& world, const BodyState& at, const TriangleMesh& mesh, const SphereCover& cover,
                       double density, int material);

}  // namespace gonogo::sim
