// Meshes of simple solids. Host only.
#pragma once
#include <utility>

#include "sim/shape/shape.h"
#include "sim/shape/triangle_mesh.h"

namespace gonogo::sim {

/// Box with the given half edges [m], every face cut into cells x cells squares of two triangles.
TriangleMesh box_mesh(const Vec3& half, int cells = 1);

/// Prism about the y axis over a regular polygon whose corners lie on the radius [m].
TriangleMesh cylinder_mesh(Real radius, Real half_length, int segments);

/// The solid of a wheel shape with its lugs, the rim between two lugs cut into `segments` chords.
TriangleMesh tyre_mesh(const Shape& wheel, int segments);

/// Solid of revolution about the z axis: `profile` is a polygon of (distance from the axis, z), off the axis, that runs
/// counterclockwise seen with z upward; `segments` chords around. A drum's rim, a silo's wall, a floor with a hole.
TriangleMesh revolved_mesh(const std::vector<std::pair<Real, Real>>& profile, int segments);

/// Open, one-sided square of cells x cells cells in the plane z = 0, normal upward.
TriangleMesh floor_mesh(Real half_edge, int cells);

}  // namespace gonogo::sim
