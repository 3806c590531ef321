// Points of a shape that may touch a plane or heightfield below it.
#pragma once
#include "sim/shape/ellipsoid.h"
#include "sim/shape/touch.h"

namespace gonogo::sim {

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

}  // namespace gonogo::sim
