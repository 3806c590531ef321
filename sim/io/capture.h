// A world at one moment: bodies and contacts copied to the host, for files and pictures.
#pragma once
#include <vector>

#include "sim/simulation/simulation.h"

namespace gonogo::sim {

/// A contact of the latest step and its impulse.
struct CapturedContact {
  Vec3d point;     // midway between the surfaces, moved with body a to the end of the step [m]
  Vec3 normal;     // unit, from b to a
  Vec3 impulse;    // on body a [N s]
  Real gap;        // at the start of the step, negative: overlap [m]
  BodyIndex a, b;  // in their world
};

struct Capture {
  double time = 0;  // [s]
  std::vector<BodyState> body;
  std::vector<CapturedContact> contact;  // empty before the first step
};

/// The state of a world now.
Capture capture_world(Simulation& simulation, WorldIndex world);

/// Centre of a shape in the world [m].
Vec3d centre_of(const Shape& shape, const BodyState& body);

/// Velocity of the point of a body where the shape's centre is [m/s].
Vec3 velocity_of(const Shape& shape, const BodyState& body);

}  // namespace gonogo::sim
