// A vehicle's bodies, joints and struts in a world of the contact engine, without shapes.
#pragma once
#include "sim/simulation/simulation.h"
#include "vehicle/model/assembly.h"

namespace gonogo::vehicle {

struct EngineBodies {
  std::vector<sim::BodyIndex> body;  // of each body of the assembly, at its centre of mass
  std::vector<Index> joint;          // of each link
};

/// Adds bodies and joints in the design position, with the vehicle's origin at `origin` and its axes along the world's.
/// A body's axes become the principal axes of its inertia.
EngineBodies add_bodies(sim::SceneWorld& world, const Assembly& assembly, const Vec3d& origin);

/// Adds the struts as springs of the engine: of a spring its table and its stops, where they have more points than the
/// engine takes those next to the design length; of a damper its slope at rest, the mean of compression and rebound.
void add_struts(sim::SceneWorld& world, const Assembly& assembly, const EngineBodies& bodies, const Vec3d& origin);

}  // namespace gonogo::vehicle
