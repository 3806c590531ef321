// Limits the contacts of a pair to kMaxTouches, for any triangulation of its surfaces.
//
// More contacts are sorted by the side of a cube to which their normals point. Each side keeps the contacts furthest
// out in eight directions along it, and the deepest: bodies rest on the corners of their common area, or on a deeper
// point between them. A gap counts against a contact, because an open contact far out carries no load.
#pragma once
#include "sim/shape/touch.h"

namespace gonogo::sim {

inline constexpr int kMaxTouches = 64;

/// Receives the contacts of a pair up to three times: to count them, to choose, and to pass on the chosen ones.
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
