#include "pipeline/lab/scenes/silo_stress.h"

#include "base/units.h"

namespace gonogo::lab {

void WallStress::add(const sim::Capture& state, const sim::SceneWorld& world, Index spheres, sim::BodyIndex wall,
                     double step) {
  for (const sim::CapturedContact& c : state.contact) {
    if (c.a != wall && c.b != wall) continue;
    const Vec3d force = static_cast<Vec3d>(c.impulse) * ((c.a == wall ? -1 : 1) / step);  // on the sphere
    const Vec3d inward = static_cast<Vec3d>(c.normal) * (c.a == wall ? -1.0 : 1.0);
    normal += dot(force, inward);
    shear += force.z;
    shear_moment += force.z * c.point.z;
  }
  for (Index b = 0; b < spheres; ++b)
    weight_moment += kGravity / double(world.mass[b].inverse_mass.x) * state.body[b].position.z;
}

}  // namespace gonogo::lab
