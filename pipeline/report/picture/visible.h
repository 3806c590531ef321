// What a picture shows: which ball or face each sample sees (ray casting with a depth buffer, rows in parallel), and
// how much light falls on it.
#pragma once
#include <cstdint>

#include "pipeline/report/picture/model.h"
#include "pipeline/report/picture/render.h"

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

// Sun and sky. The model is drawn as a height map from the sun and from a few dozen directions of the sky. A point is
// lit from a direction when nothing in that map stands higher. The sum over the sky darkens gaps between grains and the
// ground under the wheel softly and without noise.

/// Heights of a model seen along one direction, square pixels.
class HeightMap {
 public:
  HeightMap(const Model& model, const Vec3& towards_light, const Vec3& middle, Real reach, int size);

  /// Share of light from this direction at a point with a normal, in [0, 1]. Averaged over `spread` pixels to each side
  /// for soft edges of shadows.
  Real lit(const Vec3& point, const Vec3& normal, int spread) const;
  const Vec3& towards_light() const { return towards_; }

 private:
  Vec3 on_map(const Vec3& p) const;
  void raise(int column, int row, Real height);
  void draw(const Ball& ball);
  void draw(const Face& face);

  Vec3 right_, up_, towards_, middle_;
  Real pixel_;  // [m]
  int size_;
  std::vector<float> height_;
};

struct Lighting {
  std::vector<HeightMap> map;  // the sun's first, then the sky's
  Vec3 middle;                 // of the model [m]
  Real reach = 0;              // half edge of the square of floor around it that it may darken [m]
  std::vector<float> floor;    // sky over that square on a grid of kFloorPoints a side, 0 to 1

  /// Shares of what an open, level field gets.
  struct At {
    Real sun, sky;
  };
  At at(const Vec3& point, const Vec3& normal) const;
  /// Sky over a point of the floor, between points of a coarse grid: free of the edges of single directions.
  Real floor_sky(const Vec3& point) const;
};

inline constexpr int kFloorPoints = 128;

/// `towards_sun`: unit. Every direction is drawn by one thread; results do not depend on their number.
Lighting light_model(const Model& model, const Vec3& towards_sun, int threads);

}  // namespace gonogo::report
