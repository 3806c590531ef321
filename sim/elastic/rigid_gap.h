// Gap and normal of a point above a rigid shape, for plain numbers and for Dual.
#pragma once
#include "sim/elastic/dual.h"
#include "sim/elastic/model.h"

namespace gonogo::sim::elastic {

template <class T>
Vec3T<T> constant(const Vec3d& v) {
  return {T(v.x), T(v.y), T(v.z)};
}
template <class T>
Vec3d value_of(const Vec3T<T>& v) {
  return {value_of(v.x), value_of(v.y), value_of(v.z)};
}

template <class T>
struct Gap {
  T gap{};            // [m], below 0: overlap
  Vec3T<T> normal{};  // unit, out of the obstacle
};

/// `shape` displaced by `by`. The centre of a ball and the axis of a cylinder have no normal: the x axis stands in.
template <class T>
Gap<T> gap_above(const RigidShape& shape, const Vec3d& by, const Vec3T<T>& x) {
  Vec3T<T> d = x - constant<T>(shape.point + by);
  const Vec3T<T> axis = constant<T>(shape.axis);
  if (shape.kind == RigidKind::half_space) return {dot(d, axis), axis};
  if (shape.kind == RigidKind::cylinder) d -= axis * dot(d, axis);
  const T square = dot(d, d);
  if (!(value_of(square) > 0)) return {T(-shape.radius), constant<T>({1, 0, 0})};
  const T distance = root(square);
  return {distance - T(shape.radius), d * (T(1) / distance)};
}

}  // namespace gonogo::sim::elastic
