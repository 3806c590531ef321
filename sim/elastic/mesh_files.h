// Meshes read from files of Gmsh, and states written for ParaView.
#pragma once
#include <filesystem>
#include <string>

#include "sim/elastic/mesh.h"
#include "sim/elastic/simulation.h"

namespace gonogo::sim::elastic {

/// Reads a .msh file of format 4.1, text: first-order triangles or quadrilaterals (nodes at z = 0), or tetrahedra or
/// hexahedra. Physical groups of the boundary become groups of the mesh, by name, or by number where they have none.
/// `scale`: metres per unit of the file. Throws InputError, naming the file and the line, for other formats, orders and
/// mixed kinds, and as check_mesh does. Format: Gmsh reference manual, section "MSH file format".
Mesh read_gmsh(const std::filesystem::path& path, double scale = 1);

// VTK unstructured grids (.vtu, XML text), as ParaView and VTK read them.
// Format: VTK File Formats, section "XML File Formats",
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html

/// Undeformed mesh of a body; per node displacement [m], velocity [m/s], stress (xx, yy, zz, xy, yz, zx) and von Mises
/// stress [Pa]. Same state, same bytes.
std::string vtu_bytes(const Simulation& simulation, int body);
/// Writes it, whole or not at all.
void write_vtu(const std::filesystem::path& path, const Simulation& simulation, int body);

}  // namespace gonogo::sim::elastic
