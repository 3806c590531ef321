// VTK PolyData files (.vtp, XML with appended raw binary), as ParaView and VTK read them.
// Format: VTK File Formats, section "XML File Formats",
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "base/vec.h"

namespace gonogo::sim {

/// A named value per point.
struct VtpArray {
  std::string name;
  std::variant<std::vector<float>, std::vector<std::int32_t>, std::vector<Vec3>> values;
};

/// Points with values; drawn as single vertices when there are no triangles.
struct VtpContent {
  double time = 0;  // [s], stored as field TimeValue
  std::vector<Vec3d> point;
  std::vector<VtpArray> array;  // each [point]
  std::vector<std::array<Index, 3>> triangle;
};

/// The bytes of a .vtp file; same content, same bytes.
std::string vtp_bytes(const VtpContent& content);

/// Writes a .vtp file, whole or not at all.
void write_vtp(const std::filesystem::path& path, const VtpContent& content);

}  // namespace gonogo::sim
