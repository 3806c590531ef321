// Which ball or face each sample of the picture sees: ray casting with a depth buffer, rows in parallel.
#pragma once
#include <cstdint>

#include "pipeline/report/picture/camera.h"

namespace gonogo::report {

inline constexpr std::int32_t kNothing = -1;

struct Visible {
  int width = 0, height = 0;
  std::vector<float> depth;        // distance along the camera's axis [m]
  std::vector<std::int32_t> item;  // balls first, then faces; kNothing

  std::size_t at(int column, int row) const { return std::size_t(row) * width + column; }
};

/// Direction through the middle of a sample, one long along the camera's axis; x right, y up.
inline Vec3 ray_of(const Camera& camera, int width, int height, int column, int row) {
  const Real scale = 2 * camera.tan_half_height / Real(height);
  return {(Real(column) + Real(0.5) - Real(width) / 2) * scale, (Real(height) / 2 - Real(row) - Real(0.5)) * scale, 1};
}

/// Same result for any number of threads: of two items at one depth the first in the model wins.
Visible find_visible(const Model& model, const Camera& camera, int width, int height, int threads);

/// Share of each corner of a face where a ray from the origin meets its plane.
Vec3 corner_shares(const Vec3 (&corner)[3], const Vec3& ray);

}  // namespace gonogo::report
