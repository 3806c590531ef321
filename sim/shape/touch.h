// Contacts of a pair of shapes, and changes between the frames in which they are computed.
#pragma once
#include "sim/shape/shape.h"

namespace gonogo::sim {

/// One contact of a pair of shapes, the first of which is the owner.
struct Touch {
  Real gap;     // signed distance between the surfaces [m]; negative when they overlap
  Vec3 normal;  // unit, from the other shape towards the owner
  Vec3 point;   // midway between the surfaces, from the owner's centre [m]
};

/// Up to kRoom contacts of a pair, from number `first` on.
struct TouchWindow {
  static constexpr int kRoom = 16;
  int first = 0, total = 0;  // total: contacts of the pair
  Touch touch[kRoom];
  int feature[kRoom];

  GONOGO_HD void operator()(int name, const Touch& t) {
    const int k = total++ - first;
    if (k < 0 || k >= kRoom) return;
    touch[k] = t;
    feature[k] = name;
  }
  GONOGO_HD int count() const { return total - first < kRoom ? total - first : kRoom; }
};

/// The same contact owned by the other shape. `d`: from the other shape's centre to the owner's.
GONOGO_HD inline Touch seen_from_other(const Touch& t, const Vec3d& d) {
  return {t.gap, -t.normal, t.point + static_cast<Vec3>(d)};
}

GONOGO_HD inline Touch turned_to_world(const Quat& q, const Touch& t) {
  return {t.gap, rotate(q, t.normal), rotate(q, t.point)};
}

/// A world vector in the axes of orientation `q`, in double precision. 50 m from a terrain's origin a float resolves
/// 4e-6 m, and a step of 1e-3 s would turn that into a noise of 4 mm/s.
GONOGO_HD inline Vec3d in_frame(const Quat& q, const Vec3d& v) {
  const Vec3d u{-double(q.x), -double(q.y), -double(q.z)};
  const Vec3d t = 2.0 * cross(u, v);
  return v + double(q.w) * t + cross(u, t);
}

}  // namespace gonogo::sim
