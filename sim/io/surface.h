// Triangles of a shape for VTK files and pictures. Contacts never use them.
#pragma once
#include <array>
#include <vector>

#include "sim/scene/scene.h"

namespace gonogo::sim {

/// Triangles in the axes of the shape, its centre at the origin. Corners run counterclockwise seen from outside. Points
/// are repeated along sharp edges, so that each has the normal of its own side.
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

/// Volume enclosed by a closed surface [m^3], by the divergence theorem; negative when it is inside out.
double enclosed_volume(const Surface& surface);

}  // namespace gonogo::sim
