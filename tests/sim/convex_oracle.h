// Independent geometry of convex bodies in double precision: reach along a direction, signed distance of a point, and
// signed distance of two bodies as the largest separation over densely sampled, then refined directions.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/units.h"
#include "sim/shape/shape.h"
#include "tests/support/draw.h"

namespace gonogo::test {

/// Axes of an orientation, written out from the rotation matrix.
struct Axes {
  Vec3d x, y, z;
  explicit Axes(const Quat& f) {
    const double n = std::sqrt(double(f.w) * f.w + double(f.x) * f.x + double(f.y) * f.y + double(f.z) * f.z);
    const double w = f.w / n, a = f.x / n, b = f.y / n, c = f.z / n;
    x = {1 - 2 * (b * b + c * c), 2 * (a * b + w * c), 2 * (a * c - w * b)};
    y = {2 * (a * b - w * c), 1 - 2 * (a * a + c * c), 2 * (b * c + w * a)};
    z = {2 * (a * c + w * b), 2 * (b * c - w * a), 1 - 2 * (a * a + b * b)};
  }
  Vec3d into(const Vec3d& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Vec3d out_of(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// Signed distance of a point from an ellipsoid with half axes e: the nearest point is x_k = e_k^2 p_k / (t + e_k^2),
/// with the largest t for which sum (x_k / e_k)^2 is one, found by halving. On a plane of symmetry, deep inside, there
/// is none: then t is that of the least half axis, and the rest of the sum is along it.
inline double ellipsoid_distance(const Vec3d& e, const Vec3d& p) {
  const double least = std::min({e.x, e.y, e.z});
  const auto sum = [&](double t) {
    const auto term = [&](double half, double at) { return std::pow(half * at / (t + half * half), 2); };
    return term(e.x, p.x) + term(e.y, p.y) + term(e.z, p.z);
  };
  double low = -least * least, high = length(p) * std::max({e.x, e.y, e.z});
  for (int i = 0; i < 200; ++i) {
    const double t = (low + high) / 2;
    (sum(t) > 1 ? low : high) = t;
  }
  const auto on = [&](double half, double at) {
    const double below = high + half * half;
    return below > 1e-9 * half * half ? half * half * at / below : 0;
  };
  Vec3d x{on(e.x, p.x), on(e.y, p.y), on(e.z, p.z)};
  const double rest = 1 - std::pow(x.x / e.x, 2) - std::pow(x.y / e.y, 2) - std::pow(x.z / e.z, 2);
  if (rest > 1e-6) (e.x == least ? x.x : e.y == least ? x.y : x.z) = least * std::sqrt(rest);
  const double distance = length(p - x);
  return high < 0 ? -distance : distance;
}

/// Sphere, capsule, ellipsoid, cylinder or box.
struct Body {
  sim::ShapeType type;
  Vec3d size, centre;
  Axes axes;

  double reach(const Vec3d& direction) const {
    const Vec3d n = axes.into(direction);
    switch (type) {
      case sim::ShapeType::sphere:
        return size.x;
      case sim::ShapeType::capsule:
        return size.x + size.y * std::abs(n.y);
      case sim::ShapeType::ellipsoid:
        return std::sqrt(std::pow(size.x * n.x, 2) + std::pow(size.y * n.y, 2) + std::pow(size.z * n.z, 2));
      case sim::ShapeType::cylinder:
        return size.x * std::hypot(n.x, n.z) + size.y * std::abs(n.y);
      default:
        return size.x * std::abs(n.x) + size.y * std::abs(n.y) + size.z * std::abs(n.z);
    }
  }

  /// Negative inside.
  double distance(const Vec3d& point) const {
    const Vec3d p = axes.into(point - centre);
    const auto two = [](double a, double b) { return a > 0 && b > 0 ? std::hypot(a, b) : std::max(a, b); };
    switch (type) {
      case sim::ShapeType::sphere:
        return length(p) - size.x;
      case sim::ShapeType::capsule:
        return length(Vec3d{p.x, p.y - std::clamp(p.y, -size.y, size.y), p.z}) - size.x;
      case sim::ShapeType::ellipsoid:
        return ellipsoid_distance(size, p);
      case sim::ShapeType::cylinder:
        return two(std::hypot(p.x, p.z) - size.x, std::abs(p.y) - size.y);
      default: {
        const double a = std::abs(p.x) - size.x, b = std::abs(p.y) - size.y, c = std::abs(p.z) - size.z;
        const Vec3d out{std::max(a, 0.0), std::max(b, 0.0), std::max(c, 0.0)};
        return length(out) > 0 ? length(out) : std::max({a, b, c});
      }
    }
  }
};

inline double separation(const Body& a, const Body& b, const Vec3d& n) {
  return dot(n, a.centre - b.centre) - a.reach(n) - b.reach(n);
}

/// Largest separation over the directions square to an edge or side that runs along `u`, which make a crease that a
/// search among all directions does not follow: sampled around the circle, then finer about the best.
inline double separation_around(const Body& a, const Body& b, const Vec3d& u) {
  const Vec3d helper = std::abs(u.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, across = cross(u, helper);
  const Vec3d v = across * (1 / length(across)), w = cross(u, v);
  double centre = 0, half = 3.15, best = -1e300;
  for (int level = 0; level < 12; ++level) {
    const double middle = centre, samples = level == 0 ? 180 : 6;
    for (double k = -samples; k <= samples; ++k) {
      const double angle = middle + half * k / samples;
      const double at = separation(a, b, v * std::cos(angle) + w * std::sin(angle));
      if (at > best) {
        best = at;
        centre = angle;
      }
    }
    half *= level == 0 ? 1.0 / 90 : 1.0 / 3;
  }
  return best;
}

/// Largest separation near the direction n: random steps that shrink.
inline double climbed(const Body& a, const Body& b, double value, Vec3d n, Draw& draw) {
  for (double step = 0.05; step > 1e-7;) {
    bool better = false;
    for (int k = 0; k < 12; ++k) {
      const Vec3d moved = n + draw.direction() * step, unit = moved * (1 / length(moved));
      const double at = separation(a, b, unit);
      if (at > value) {
        value = at;
        n = unit;
        better = true;
      }
    }
    if (!better) step *= 0.6;
  }
  return value;
}

/// Largest separation over all directions.
inline double signed_distance(const Body& a, const Body& b) {
  std::vector<std::pair<double, Vec3d>> found;
  const int samples = 4000;
  for (int k = 0; k < samples; ++k) {
    const double z = 1 - (2 * k + 1.0) / samples, ring = std::sqrt(1 - z * z), angle = 2.399963229728653 * k;
    const Vec3d n{ring * std::cos(angle), ring * std::sin(angle), z};
    found.push_back({separation(a, b, n), n});
  }
  // Flat faces and pairs of edges make ridges, which a search along few directions does not climb: their normals too.
  for (const Body* body : {&a, &b})
    for (const Vec3d& n : {body->axes.x, body->axes.y, body->axes.z})
      for (const double sign : {-1.0, 1.0}) found.push_back({separation(a, b, n * sign), n * sign});
  for (const Vec3d& u : {a.axes.x, a.axes.y, a.axes.z})
    for (const Vec3d& v : {b.axes.x, b.axes.y, b.axes.z})
      for (const double sign : {-1.0, 1.0}) {
        const Vec3d n = cross(u, v) * sign;
        if (length(n) > 1e-6) found.push_back({separation(a, b, n * (1 / length(n))), n * (1 / length(n))});
      }
  std::sort(found.begin(), found.end(), [](const auto& p, const auto& q) { return p.first > q.first; });
  Draw draw(77);
  double best = found[0].first;
  for (std::size_t start = 0; start < 12; ++start)
    best = std::max(best, climbed(a, b, found[start].first, found[start].second, draw));
  for (const Body* body : {&a, &b})
    for (const Vec3d& u : {body->axes.x, body->axes.y, body->axes.z}) best = std::max(best, separation_around(a, b, u));
  return best;
}

/// The convex parts of a sphere, capsule, cylinder, box or lugged wheel.
inline std::vector<Body> parts(const sim::Shape& s, const Vec3d& centre, const Quat& q) {
  const Axes axes(q);
  const auto size = static_cast<Vec3d>(s.size);
  if (s.type != sim::ShapeType::wheel) return {{s.type, size, centre, axes}};
  std::vector<Body> list{{sim::ShapeType::cylinder, size, centre, axes}};
  for (int k = 0; k < s.lug_count; ++k) {
    const double angle = 2 * kPi * k / s.lug_count;
    Body lug{sim::ShapeType::box, {size.z, size.y, 0.5 * s.lug_thickness}, centre, axes};
    const Vec3d out = axes.x * std::cos(angle) + axes.z * std::sin(angle);
    lug.axes.z = axes.z * std::cos(angle) - axes.x * std::sin(angle);
    lug.axes.x = out;
    lug.centre += out * size.x;
    list.push_back(lug);
  }
  return list;
}

}  // namespace gonogo::test
