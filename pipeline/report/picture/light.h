// Sun and sky. The model is drawn as a height map from the sun and from a few dozen directions of the sky. A point is
// lit from a direction when nothing in that map stands higher. The sum over the sky darkens gaps between grains and the
// ground under the wheel softly and without noise.
#pragma once
#include "pipeline/report/picture/model.h"

namespace gonogo::report {

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
