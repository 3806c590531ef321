// Loss of rubber: beside each spring of stiffness K stand three Maxwell branches of stiffness g K, a decade apart, so
// that the loss factor hardly depends on the frequency w. With w in units of the middle rate (500 rad/s),
//   E'' / K = g sum_k w_k / (1 + w_k^2),   E' / K = 1 + g sum_k w_k^2 / (1 + w_k^2),   w_k = 10 w, w, w / 10
// and g is such that E'' / E' is the loss factor at w = 1. Over 50 to 5000 rad/s the loss factor keeps within a sixth
// of it.
#pragma once
#include <array>

namespace gonogo::sim::elastic {

inline constexpr int kBranches = 3;
inline constexpr std::array<double, kBranches> kRate{50, 500, 5000};  // [1/s]

/// g of a loss factor, which must be below 0.4 [-].
inline double branch_share(double loss) {
  double viscous = 0, stored = 0;
  for (const double rate : kRate) {
    const double w = kRate[1] / rate;
    viscous += w / (1 + w * w);
    stored += w * w / (1 + w * w);
  }
  return loss / (viscous - loss * stored);
}

}  // namespace gonogo::sim::elastic
