#include "vehicle/feasible/pressure.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonogo::vehicle {
namespace {

/// Twice the area of the triangle a b c; positive when it turns left.
double turn(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Corners of the convex hull in counter-clockwise order (Andrew's monotone chain).
std::vector<Vec3d> hull_of(std::vector<Vec3d> point) {
  std::sort(point.begin(), point.end(),
            [](const Vec3d& a, const Vec3d& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<Vec3d> hull;
  const auto add = [&](const Vec3d& p, std::size_t kept) {
    while (hull.size() > kept && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec3d& p : point) add(p, 1);
  const std::size_t lower = hull.size();
  for (auto p = point.rbegin() + 1; p != point.rend(); ++p) add(*p, lower);
  hull.pop_back();
  return hull;
}

}  // namespace

std::optional<Pressure> centre_of_pressure(const std::vector<Vec3d>& point, const std::vector<double>& normal) {
  if (point.size() < 3) return std::nullopt;
  const std::vector<Vec3d> hull = hull_of(point);
  if (hull.size() < 3) return std::nullopt;
  Vec3d centre;
  double sum = 0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    centre += normal[i] * point[i];
    sum += normal[i];
  }
  centre *= 1 / sum;
  Pressure p{centre.x, centre.y, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec3d &a = hull[i], &b = hull[(i + 1) % hull.size()];
    p.edge = std::min(p.edge, turn(a, b, centre) / std::hypot(b.x - a.x, b.y - a.y));
  }
  return p;
}

}  // namespace gonogo::vehicle
