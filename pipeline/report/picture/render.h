// A model as a picture: ray-cast spheres and triangles, sun and sky, two by two samples per pixel.
#pragma once
#include "pipeline/report/picture/camera.h"
#include "pipeline/report/picture/image.h"

namespace gonogo::report {

/// Same bytes for any number of threads.
Image render(const Model& model, const Camera& camera, int width, int height, int threads);

/// sRGB code, 0 to 255, of linear light.
std::uint8_t srgb(Real light);

}  // namespace gonogo::report
