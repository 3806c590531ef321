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
#include <vector>

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

}  // namespace gonogo::sim
