// Triangle meshes and heightfields of a scene, which worlds share by pointers. Host only.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/math/vec.h"

namespace gonogo::sim {

/// Triangles in the axes of the shape, its centre at the origin; corners run counterclockwise seen from outside.
struct TriangleMesh {
  std::string name;            // for messages
  std::vector<Vec3> vertex{};  // [m]
  std::vector<std::array<Index, 3>> triangle{};
  bool open = false;  // one-sided ground, which may have a rim, instead of the boundary of a solid
};

/// Heights over a regular grid centred on the shape's centre, x running fastest. Cells are cut along the diagonal from
/// their lowest x and y. There is no ground beyond the grid.
struct Heightfield {
  std::string name;
  Index nx = 0, ny = 0;
  Real spacing_x = 0, spacing_y = 0;  // [m]
  std::vector<Real> height;           // [nx * ny], along the shape's z axis [m]
};

/// Throws InputError, naming the mesh and the triangle, edge or number. Refuses meshes that are empty, not finite or
/// inside out. Refuses degenerate triangles, edges of more than two triangles, neighbours wound against each other, and
/// a rim unless the mesh is open.
void check_mesh(const TriangleMesh& mesh);

/// Throws InputError for fewer than two heights a side, spacings not above zero, and missing or infinite heights.
void check_heightfield(const Heightfield& field);

/// Largest distance of a vertex from the origin [m].
Real reach_of(const TriangleMesh& mesh);
/// Half of the smallest side of the box around all vertices [m].
Real min_half_of(const TriangleMesh& mesh);
/// Distance of the furthest point from the origin [m].
Real reach_of(const Heightfield& field);

}  // namespace gonogo::sim
