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
    GONOGO_ASSERT(is_unit(t.normal));
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

inline constexpr int kMaxTouches = 64;

/// Limits the contacts of a pair to kMaxTouches, for any triangulation of its surfaces. Receives them up to three
/// times: to count them, to choose, and to pass on the chosen ones.
///
/// More contacts are sorted by the side of a cube to which their normals point. Each side keeps the contacts furthest
/// out in eight directions along it, and the deepest: bodies rest on the corners of their common area, or on a deeper
/// point between them. A gap counts against a contact, because an open contact far out carries no load.
class TouchChooser {
 public:
  GONOGO_HD explicit TouchChooser(TouchWindow& window) : window_(window) {}

  GONOGO_HD void operator()(int feature, const Touch& t) {
    const int number = count_++;
    if (pass_ == 0 || (pass_ == 2 && is_chosen(number))) window_(feature, t);
    if (pass_ == 1) rate(number, t);
  }

  /// Whether the contacts must be visited once more.
  GONOGO_HD bool next_pass() {
    if (pass_ == 2 || count_ <= kMaxTouches) return false;
    ++pass_;
    count_ = window_.total = 0;
    if (pass_ == 1)
      for (Best& b : best_) b = {Real(-1e30), -1};
    return true;
  }

 private:
  static constexpr int kWays = 9;  // eight directions and down
  struct Best {
    Real score;
    int number;
  };
  TouchWindow& window_;
  int pass_ = 0, count_ = 0;
  Best best_[6 * kWays];  // set by next_pass: most pairs never need it

  GONOGO_HD void rate(int number, const Touch& t) {
    const Real n[3] = {t.normal.x, t.normal.y, t.normal.z}, p[3] = {t.point.x, t.point.y, t.point.z};
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::fabs(n[k]) > std::fabs(n[axis])) axis = k;
    const Real u = p[(axis + 1) % 3], v = p[(axis + 2) % 3], open = 50 * std::fmax(t.gap, Real(0));
    const Real diagonal = Real(0.70710678);
    const Real score[kWays] = {u,  diagonal * (u + v), v,     diagonal * (v - u), -u, -diagonal * (u + v),
                               -v, diagonal * (u - v), -t.gap};
    Best* best = best_ + kWays * (2 * axis + (n[axis] > 0 ? 1 : 0));
    for (int k = 0; k < kWays; ++k) {
      const Real value = k + 1 < kWays ? score[k] - open : score[k];
      if (value > best[k].score) best[k] = {value, number};
    }
  }

  GONOGO_HD bool is_chosen(int number) const {
    for (const Best& b : best_)
      if (b.number == number) return true;
    return false;
  }
};

}  // namespace gonogo::sim
