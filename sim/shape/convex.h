// Capsules, ellipsoids, cylinders and boxes as convex bodies: reach, nearest point, and the corner, edge or face that
// is furthest in a direction. All in world axes.
#pragma once
#include <initializer_list>

#include "sim/shape/ellipsoid.h"
#include "sim/shape/low_points.h"

namespace gonogo::sim {

struct Convex {
  ShapeType type;
  Vec3 size;  // as in Shape
  Vec3 centre;
  Vec3 axis[3];

  GONOGO_HD Vec3 into(const Vec3& v) const { return {dot(axis[0], v), dot(axis[1], v), dot(axis[2], v)}; }
  GONOGO_HD Vec3 out_of(const Vec3& v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }
};

GONOGO_HD inline Convex convex(ShapeType type, const Vec3& size, const Vec3& centre, const Quat& q) {
  return {type, size, centre, {rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0}), rotate(q, {0, 0, 1})}};
}

/// Reach from the centre along a unit direction [m].
GONOGO_HD inline Real extent(const Convex& c, const Vec3& direction) {
  const Vec3 n = c.into(direction);
  if (c.type == ShapeType::box)
    return c.size.x * std::fabs(n.x) + c.size.y * std::fabs(n.y) + c.size.z * std::fabs(n.z);
  if (c.type == ShapeType::ellipsoid) return length(scale(c.size, n));
  const Real side = c.type == ShapeType::capsule ? Real(1) : std::sqrt(n.x * n.x + n.z * n.z);
  return c.size.y * std::fabs(n.y) + c.size.x * side;
}

/// Radius of the largest sphere inside [m].
GONOGO_HD inline Real min_half(const Convex& c) {
  if (c.type == ShapeType::capsule) return c.size.x;
  const Real smallest = std::fmin(c.size.x, c.size.y);
  return c.type == ShapeType::box || c.type == ShapeType::ellipsoid ? std::fmin(smallest, c.size.z) : smallest;
}

/// Whether the body touches any other convex one in a single point.
GONOGO_HD inline bool is_strictly_convex(const Convex& c) { return c.type == ShapeType::ellipsoid; }

GONOGO_HD inline Real clamped(Real x, Real limit) { return std::fmin(std::fmax(x, -limit), limit); }

/// Point nearest to `p` of the body's core. The core is smaller by `share` of the smallest half extent, an ellipsoid's
/// by `share` of each half axis; a capsule's is its axis. Cores of bodies with less overlap are apart.
GONOGO_HD inline Vec3 nearest_in_core(const Convex& c, const Vec3& p, Real share) {
  if (c.type == ShapeType::ellipsoid) {
    const Vec3 half = c.size * (1 - share), q = c.into(p - c.centre);
    const Vec3 inside{q.x / half.x, q.y / half.y, q.z / half.z};
    return dot(inside, inside) <= 1 ? p : c.centre + c.out_of(nearest_on_ellipsoid(half, q));
  }
  const Real margin = c.type == ShapeType::capsule ? c.size.x : share * min_half(c);
  Vec3 q = c.into(p - c.centre);
  if (c.type == ShapeType::box) {
    q = {clamped(q.x, c.size.x - margin), clamped(q.y, c.size.y - margin), clamped(q.z, c.size.z - margin)};
  } else {
    const Real radius = c.size.x - margin, from_axis = std::sqrt(q.x * q.x + q.z * q.z);
    const Real shrink = from_axis > radius ? radius / from_axis : Real(1);
    q = {q.x * shrink, clamped(q.y, c.type == ShapeType::capsule ? c.size.y : c.size.y - margin), q.z * shrink};
  }
  return c.centre + c.out_of(q);
}

/// A corner, edge or flat face: its points, in order around it, and their numbers on the body.
inline constexpr int kMaxCorners = 8;
struct Facet {
  int count = 0;
  Vec3 point[kMaxCorners];
  int id[kMaxCorners];
  Vec3 normal;  // of a face, outward

  GONOGO_HD void add(const Vec3& p, int name) {
    point[count] = p;
    id[count++] = name;
  }
};

// The whole face (or edge) is the facet while it is within ten degrees of square to the direction. Each of its points
// then gets its own gap. Cosine and sine of these angles.
inline constexpr Real kSquare = Real(0.985), kLevel = Real(0.174);

GONOGO_HD inline Facet box_facet(const Convex& c, const Vec3& direction) {
  const Vec3 v = c.into(direction);
  const Real n[3] = {v.x, v.y, v.z}, half[3] = {c.size.x, c.size.y, c.size.z};
  int largest = 0, smallest = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::fabs(n[k]) > std::fabs(n[largest])) largest = k;
    if (std::fabs(n[k]) < std::fabs(n[smallest])) smallest = k;
  }
  const int toward = (n[0] > 0 ? 1 : 0) | (n[1] > 0 ? 2 : 0) | (n[2] > 0 ? 4 : 0);
  Facet f;
  const auto add = [&](int corner) {
    f.add(c.centre + c.axis[0] * (corner & 1 ? half[0] : -half[0]) + c.axis[1] * (corner & 2 ? half[1] : -half[1]) +
              c.axis[2] * (corner & 4 ? half[2] : -half[2]),
          corner);
  };
  if (std::fabs(n[largest]) > kSquare) {
    const int u = 1 << ((largest + 1) % 3), w = 1 << ((largest + 2) % 3), side = toward & (1 << largest);
    for (const int corner : {side, side | u, side | u | w, side | w}) add(corner);
    f.normal = c.axis[largest] * (n[largest] > 0 ? Real(1) : Real(-1));
  } else if (std::fabs(n[smallest]) < kLevel) {
    add(toward & ~(1 << smallest));
    add(toward | (1 << smallest));
  } else {
    add(toward);
  }
  return f;
}

/// The line along the side of a capsule or cylinder that is furthest in a direction: both ends, or the further one.
GONOGO_HD inline Facet side_facet(const Convex& c, const Vec3& direction, const Vec3& out) {
  const Real along = dot(c.axis[1], direction);
  Facet f;
  for (int end = 0; end < 2; ++end)
    if (std::fabs(along) < kLevel || (end == 1) == (along > 0))
      f.add(c.centre + c.axis[1] * (end == 0 ? -c.size.y : c.size.y) + out, 16 * end);
  return f;
}

/// The corner, edge or face of a body that is furthest in a unit direction.
GONOGO_HD inline Facet facet(const Convex& c, const Vec3& direction) {
  if (c.type == ShapeType::box) return box_facet(c, direction);
  if (c.type == ShapeType::ellipsoid) {
    Facet f;
    f.add(c.centre + c.out_of(ellipsoid_support(c.size, c.into(direction))), 0);
    return f;
  }
  if (c.type == ShapeType::capsule) return side_facet(c, direction, direction * c.size.x);
  const Real along = dot(c.axis[1], direction);
  const Vec3 across = direction - c.axis[1] * along;
  const Real slope = length(across);
  const bool leans = slope > Real(1e-3);  // see visit_rim_points
  const Vec3 out = leans ? across * (c.size.x / slope) : c.axis[0] * c.size.x;
  if (std::fabs(along) <= kSquare) return side_facet(c, direction, out);
  Facet f;
  f.normal = along > 0 ? c.axis[1] : -c.axis[1];
  const Vec3 centre = c.centre + f.normal * c.size.y, second = cross(c.axis[1], out);
  for (int k = 0; k < kMaxCorners; ++k) {
    const Real angle = Real(k) * Real(0.7853981633974483);
    f.add(centre + out * std::cos(angle) + second * std::sin(angle), (along > 0 ? 16 : 0) + k);
  }
  return f;
}

}  // namespace gonogo::sim
