// A run as files for ParaView. Open the .pvd files of the folder:
//   spheres.pvd   one point per sphere: radius, velocity, angular_velocity, speed, body, material
//                 (representation "Point Gaussian" or filter "Glyph", scaled by twice the radius)
//   surfaces.pvd  all other shapes as triangles: Normals, velocity, body, material
//   contacts.pvd  one point per contact: normal, impulse [N s], gap [m], body_a, body_b
// Units are SI; the frame is the world's. Files of frame k end in _k.vtp. Each file is whole or absent, and a .pvd
// names only complete frames, so that the series of a killed run opens.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "base/math/vec.h"
#include "sim/io/capture.h"

namespace gonogo::sim {

class VtkSeries {
 public:
  /// Writes frames of `world` to `folder`, which is created. Replaces the .pvd files of an earlier series there.
  VtkSeries(std::filesystem::path folder, const SceneWorld& world);

  /// Adds a frame. Throws DeviceError when a file cannot be written.
  void write(const Capture& frame);

  int frame_count() const { return int(time_.size()); }

 private:
  void write_collection(const std::string& kind) const;

  std::filesystem::path folder_;
  SceneWorld drawn_;  // shapes, meshes and heightfields only
  Real plane_half_;   // [m]
  std::vector<double> time_;
};

// VTK PolyData files (.vtp, XML with appended raw binary), as ParaView and VTK read them.
// Format: VTK File Formats, section "XML File Formats",
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html

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
