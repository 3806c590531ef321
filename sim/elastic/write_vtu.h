// VTK unstructured grids (.vtu, XML text), as ParaView and VTK read them.
// Format: VTK File Formats, section "XML File Formats",
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
#pragma once
#include <filesystem>
#include <string>

#include "sim/elastic/simulation.h"

namespace gonogo::sim::elastic {

/// Undeformed mesh of a body; per node displacement [m], velocity [m/s], stress (xx, yy, zz, xy, yz, zx) and von Mises
/// stress [Pa]. Same state, same bytes.
std::string vtu_bytes(const Simulation& simulation, int body);
/// Writes it, whole or not at all.
void write_vtu(const std::filesystem::path& path, const Simulation& simulation, int body);

}  // namespace gonogo::sim::elastic
