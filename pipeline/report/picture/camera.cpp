#include "pipeline/report/picture/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonogo::report {
namespace {

/// Tangents of what a camera sees of a set of points, and the least distance of any of them.
struct Extent {
  double left = std::numeric_limits<double>::max(), right = -left, bottom = left, top = -left, nearest = left;
};

Extent extent_of(const Camera& camera, const std::vector<Vec3>& points) {
  Extent e;
  for (const Vec3& p : points) {
    const Vec3 s = camera.seen(p);
    e.nearest = std::min(e.nearest, double(s.z));
    e.left = std::min(e.left, double(s.x) / s.z);
    e.right = std::max(e.right, double(s.x) / s.z);
    e.bottom = std::min(e.bottom, double(s.y) / s.z);
    e.top = std::max(e.top, double(s.y) / s.z);
  }
  return e;
}

std::vector<Vec3> outline(const Model& model) {
  std::vector<Vec3> points;
  for (const Ball& b : model.ball)
    for (const Real side : {b.radius, -b.radius})
      for (const Vec3& off : {Vec3{side, 0, 0}, Vec3{0, side, 0}, Vec3{0, 0, side}}) points.push_back(b.centre + off);
  for (const Face& f : model.face) points.insert(points.end(), f.corner, f.corner + 3);
  if (points.empty()) points = {{-1, -1, -1}, {1, 1, 1}};
  return points;
}

}  // namespace

Camera frame_model(const Model& model, double azimuth, double elevation, double aspect, const Margins& m) {
  const std::vector<Vec3> points = outline(model);
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Camera c;
  const double a = azimuth, e = elevation;
  c.right = {Real(std::cos(a)), Real(std::sin(a)), 0};
  c.forward = {Real(-std::sin(a) * std::cos(e)), Real(std::cos(a) * std::cos(e)), Real(-std::sin(e))};
  c.up = cross(c.right, c.forward);
  // Each round measures the picture from the present place, then moves sideways to centre it between the margins and
  // along the view to fill them; perspective makes it a fixed point, reached to a pixel in a few rounds.
  const double t = c.tan_half_height, wide = (1 - m.left - m.right) * t * aspect, tall = (1 - m.top - m.bottom) * t;
  const Vec3 middle = (low + high) * Real(0.5);
  double distance = 4 * length(high - low) + 1, across = 0, rise = 0;
  for (int round = 0; round < 30; ++round) {
    c.eye = middle + c.right * Real(across) + c.up * Real(rise) - c.forward * Real(distance);
    const Extent x = extent_of(c, points);
    const double grow = std::max((x.right - x.left) / (2 * wide), (x.top - x.bottom) / (2 * tall));
    across += ((x.left + x.right) / 2 - (m.left - m.right) * t * aspect * grow) * distance;
    rise += ((x.bottom + x.top) / 2 - (m.bottom - m.top) * t * grow) * distance;
    distance = std::max(distance * grow, distance - 0.9 * x.nearest);
  }
  return c;
}

}  // namespace gonogo::report
