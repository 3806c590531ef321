// Meshes of simple solids, and meshes from files. Host only.
#pragma once
#include <filesystem>
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

/// Reads a mesh from .stl (binary or text) or .obj (vertices and faces; other lines are skipped). Equal positions
/// become one vertex, and faces with more than three corners become fans. `scale`: metres per unit of the file. Throws
/// InputError, naming the file and the line or byte, for unreadable files and for meshes that check_mesh refuses.
TriangleMesh read_mesh(const std::filesystem::path& path, double scale = 1, bool open = false);

/// Writes a mesh as binary STL, whole or not at all.
void write_stl(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace gonogo::sim
