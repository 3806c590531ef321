// What is drawn of a world, for files and pictures: bodies and contacts copied to the host, and triangles of its
// shapes.
#pragma once
#include <array>
#include <vector>

#include "sim/scene/scene.h"
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
  std::vector<CapturedContact> contact{};  // empty before the first step
};

/// The state of a world now.
Capture capture_world(Simulation& simulation, WorldIndex world);

/// Centre of a shape in the world [m].
Vec3d centre_of(const Shape& shape, const BodyState& body);

/// Velocity of the point of a body where the shape's centre is [m/s].
Vec3 velocity_of(const Shape& shape, const BodyState& body);

/// Triangles in the axes of a shape, its centre at the origin; contacts never use them. Corners run counterclockwise
/// seen from outside. Points are repeated along sharp edges, so that each has the normal of its own side.
struct Surface {
  std::vector<Vec3> point;   // [m]
  std::vector<Vec3> normal;  // [point], unit, outward
  std::vector<std::array<Index, 3>> triangle;
};

/// Resolution of round shapes, and size of the drawn part of a plane.
struct SurfaceDetail {
  int segments = 48;    // around a full turn, at least 3
  Real plane_half = 1;  // half edge of the square drawn of a plane [m]
};

/// The surface of any shape other than meshes and heightfields.
Surface surface_of(const Shape& shape, const SurfaceDetail& detail = {});

/// The surface of any shape of a world, its meshes and heightfields included.
Surface surface_of(const SceneWorld& world, const Shape& shape, const SurfaceDetail& detail = {});

}  // namespace gonogo::sim
