// Capsules, ellipsoids, cylinders and boxes as convex bodies: reach, nearest point, and the corner, edge or face that
// is furthest in a direction. All in world axes.
// Also the points of a shape that may touch a plane or heightfield below it.
//
// Ellipsoids. With half axes e and A = diag(e), in their own axes: the reach along a unit direction n is |A n|, the
// furthest point A^2 n / |A n|. The outward normal at a point x of the surface is along A^-2 x.
#pragma once
#include <initializer_list>

#include "sim/shape/touch/gap.h"
#include "sim/shape/touch/touch.h"

namespace gonogo::sim {

/// Furthest point along a direction of any length; own axes [m].
GONOGO_HD inline Vec3 ellipsoid_support(const Vec3& half, const Vec3& direction) {
  GONOGO_ASSERT(half.x > 0 && half.y > 0 && half.z > 0);
  const Vec3 stretched = scale(half, direction);
  return scale(half, stretched) * (1 / length(stretched));
}

/// Outward unit normal at a point of the surface.
GONOGO_HD inline Vec3 ellipsoid_normal(const Vec3& half, const Vec3& x) {
  const Vec3 n{x.x / (half.x * half.x), x.y / (half.y * half.y), x.z / (half.z * half.z)};
  return n * (1 / length(n));
}

/// Point of the surface nearest to `p`, inside or outside: x_k = e_k^2 p_k / (s + e_k^2 - m^2), m the smallest half
/// axis, with s > 0 such that sum (x_k / e_k)^2 = 1 (Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a
/// Hyperellipsoid, 2013). The sum falls with s and is convex, so Newton's method from the left does not pass the root.
/// Lengths are in units of m. A point within a millionth of the plane of symmetry counts as in it; of two points that
/// are then equally near, one is returned.
GONOGO_HD_OUTLINED Vec3 nearest_on_ellipsoid(const Vec3& half, const Vec3& p) {
  const Real least = std::fmin(half.x, std::fmin(half.y, half.z));
  const Real e[3] = {half.x / least, half.y / least, half.z / least}, at[3] = {p.x / least, p.y / least, p.z / least};
  Real weight[3], shift[3], s = 0;
  for (int k = 0; k < 3; ++k) {
    weight[k] = e[k] * std::fmax(std::fabs(at[k]), Real(1e-6));
    shift[k] = (e[k] - 1) * (e[k] + 1);
    s = std::fmax(s, weight[k] - shift[k]);  // no term of the sum is above one there, and one of them is
  }
  for (int i = 0; i < 20; ++i) {
    Real excess = -1, slope = 0;
    for (int k = 0; k < 3; ++k) {
      const Real ratio = weight[k] / (s + shift[k]), square = ratio * ratio;
      excess += square;
      slope += square / (s + shift[k]);
    }
    const Real step = excess / (2 * slope);
    s += std::fmax(step, Real(0));
    if (!(step > Real(1e-7) * s)) break;
  }
  Real x[3], sum = 0;
  for (int k = 0; k < 3; ++k) {
    x[k] = weight[k] / (s + shift[k]);  // of the half axis
    sum += x[k] * x[k];
    if (at[k] < 0) x[k] = -x[k];
  }
  const Real onto = 1 / std::sqrt(sum);
  return {half.x * x[0] * onto, half.y * x[1] * onto, half.z * x[2] * onto};
}

/// A sphere against an ellipsoid. `p`: the sphere's centre in the ellipsoid's axes. Inside, the normal leads out
/// through the nearest point.
GONOGO_HD inline Gap sphere_ellipsoid_gap(const Vec3& p, const Vec3& half, Real radius) {
  const Vec3 x = nearest_on_ellipsoid(half, p), n = ellipsoid_normal(half, x);
  return {dot(p - x, n) - radius, n};
}

/// Features of visit_low_points below this number are points of rims, corners or ends; lug corners follow.
inline constexpr int kFirstLugFeature = 32;

/// Rims of a cylinder about the y axis of `q`: the lowest point of each rim, or eight points around a flat cap. The
/// eight start at the lowest point, or at the x axis while the cap is level to 1e-3, because the lowest point is then
/// noise.
template <class Visit>
GONOGO_HD inline void visit_rim_points(Real radius, Real half_length, const Quat& q, const Vec3& up, Visit&& visit) {
  const Vec3 axis = rotate(q, {0, 1, 0});
  const Real along = dot(axis, up);
  const Vec3 down = axis * along - up;
  const Real slope = length(down);
  const bool leans = slope > Real(1e-3);
  const Vec3 first = leans ? down * (radius / slope) : rotate(q, {radius, 0, 0});
  const Vec3 second = cross(axis, first);
  for (int cap = 0; cap < 2; ++cap) {
    const Vec3 centre = axis * (cap == 0 ? -half_length : half_length);
    const bool flat = (cap == 0 ? along : -along) > Real(0.9);
    if (leans || flat) visit(16 * cap, centre + first);
    for (int k = 1; flat && k < 8; ++k) {
      const Real angle = Real(k) * Real(0.7853981633974483);
      visit(16 * cap + k, centre + first * std::cos(angle) + second * std::sin(angle));
    }
  }
}

/// Outer corners of the two lugs nearest to the ground.
template <class Visit>
GONOGO_HD inline void visit_lug_corners(const Shape& wheel, const Quat& q, const Vec3& up, Visit&& visit) {
  const Vec3 up_B = rotate_back(q, up), half = lug_half(wheel);
  visit_nearest_lugs(wheel, std::atan2(-up_B.z, -up_B.x), [&](int lug) {
    const LugFrame frame = lug_frame(wheel, lug);
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 p{wheel.size.x + half.x, corner & 1 ? half.y : -half.y, corner & 2 ? half.z : -half.z};
      visit(kFirstLugFeature + 4 * lug + corner, rotate(q, frame.out_of(p)));
    }
  });
}

/// From a box's centre to one of its corners: bits 1, 2, 4 of `corner` choose the positive side along x, y, z.
GONOGO_HD inline Vec3 box_corner(const Vec3& half, const Quat& q, int corner) {
  GONOGO_ASSERT(corner >= 0 && corner < 8);
  return rotate(q, {corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y, corner & 4 ? half.z : -half.z});
}

/// Calls visit(feature, point) for the points of a shape that may be lowest against the unit direction `up`. Points are
/// relative to the shape's centre, in world axes like `q` and `up`. For meshes see field_touch.h.
template <class Visit>
GONOGO_HD inline void visit_low_points(const Shape& s, const Quat& q, const Vec3& up, Visit&& visit) {
  switch (s.type) {
    case ShapeType::sphere:
      visit(0, up * -s.size.x);
      return;
    case ShapeType::capsule:
      for (int end = 0; end < 2; ++end) visit(end, rotate(q, {0, end == 0 ? -s.size.y : s.size.y, 0}) - up * s.size.x);
      return;
    case ShapeType::ellipsoid:
      visit(0, rotate(q, -ellipsoid_support(s.size, rotate_back(q, up))));
      return;
    case ShapeType::box:
      for (int corner = 0; corner < 8; ++corner) visit(corner, box_corner(s.size, q, corner));
      return;
    case ShapeType::wheel:
      visit_lug_corners(s, q, up, visit);
      [[fallthrough]];
    case ShapeType::cylinder:
      visit_rim_points(s.size.x, s.size.y, q, up, visit);
      return;
    default:
      return;
  }
}

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
