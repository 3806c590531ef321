// A model as a picture in memory: ray-cast spheres and triangles, sun and sky, two by two samples per pixel.
#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/report/picture/model.h"

namespace gonogo::report {

/// Perspective camera in the level frame; up in the picture is up in the world.
struct Camera {
  Vec3 eye;                 // [m]
  Vec3 right, up, forward;  // unit
  Real tan_half_height = Real(0.13);

  /// x right, y up, z ahead [m].
  Vec3 seen(const Vec3& p) const {
    const Vec3 d = p - eye;
    return {dot(d, right), dot(d, up), dot(d, forward)};
  }
};

/// Share of the picture's width and height left free on each side.
struct Margins {
  double left = 0.04, right = 0.04, top = 0.06, bottom = 0.06;
};

/// Looks at a model from the right of its x axis, turned by `azimuth` towards its front and raised by `elevation`
/// [rad]. The camera is as near as the margins allow. `aspect`: width over height.
Camera frame_model(const Model& model, double azimuth, double elevation, double aspect, const Margins& margins);

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height][width][3], sRGB, top row first
};

/// Same bytes for any number of threads.
Image render(const Model& model, const Camera& camera, int width, int height, int threads);

/// sRGB code, 0 to 255, of linear light.
std::uint8_t srgb(Real light);

}  // namespace gonogo::report
