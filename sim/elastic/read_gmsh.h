// Meshes of Gmsh.
#pragma once
#include <filesystem>

#include "sim/elastic/mesh.h"

namespace gonogo::sim::elastic {

/// Reads a .msh file of format 4.1, text: first-order triangles or quadrilaterals (nodes at z = 0), or tetrahedra or
/// hexahedra. Physical groups of the boundary become groups of the mesh, by name, or by number where they have none.
/// `scale`: metres per unit of the file. Throws InputError, naming the file and the line, for other formats, orders and
/// mixed kinds, and as check_mesh does. Format: Gmsh reference manual, section "MSH file format".
Mesh read_gmsh(const std::filesystem::path& path, double scale = 1);

}  // namespace gonogo::sim::elastic
