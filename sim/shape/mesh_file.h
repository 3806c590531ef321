// Meshes from files. Host only.
#pragma once
#include <filesystem>

#include "sim/shape/triangle_mesh.h"

namespace gonogo::sim {

/// Reads a mesh from .stl (binary or text) or .obj (vertices and faces; other lines are skipped). Equal positions
/// become one vertex, and faces with more than three corners become fans. `scale`: metres per unit of the file. Throws
/// InputError, naming the file and the line or byte, for unreadable files and for meshes that check_mesh refuses.
TriangleMesh read_mesh(const std::filesystem::path& path, double scale = 1, bool open = false);

/// Writes a mesh as binary STL, whole or not at all.
void write_stl(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace gonogo::sim
