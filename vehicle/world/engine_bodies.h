// A vehicle's bodies, joints and struts in a world of the contact engine, without shapes.
#pragma once
#include "sim/simulation/simulation.h"
#include "vehicle/model/assembly.h"

namespace gonogo::vehicle {

struct EngineBodies {
  std::vector<sim::BodyIndex> body;  // of each body of the assembly, at its centre of mass
  std::vector<Index> joint;          // of each link
};

/// Adds bodies and joints in the design position. The vehicle's origin is at `origin`, its axes are the world's. The
/// axes of a body are the principal axes of its inertia.
EngineBodies add_bodies(sim::SceneWorld& world, const Assembly& assembly, const Vec3d& origin);

/// Adds the struts as springs of the engine. A spring keeps its table and stops; of a table with too many points for
/// the engine, the points next to the design length. A damper becomes its slope at rest, the mean of compression and
/// rebound.
void add_struts(sim::SceneWorld& world, const Assembly& assembly, const EngineBodies& bodies, const Vec3d& origin);

/// Adds a motor; returns its index.
Index add_motor(sim::SceneWorld& world, const sim::Motor& motor);

}  // namespace gonogo::vehicle
