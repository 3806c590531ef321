// Loss of rubber. A spring of stiffness K at the middle rate (500 rad/s) is a long-time spring K_0 and, beside it,
// three Maxwell branches of stiffness g K_0, a decade apart, so that the loss factor hardly depends on the frequency w:
//   E'' / K_0 = g sum_k w_k / (1 + w_k^2),   E' / K_0 = 1 + g sum_k w_k^2 / (1 + w_k^2),   w_k = w / rate_k
// g makes E'' / E' the loss factor at the middle rate, and K_0 makes E' there equal to K. Christensen, Theory of
// viscoelasticity, 1982, section 1.6.
#pragma once
#include <array>
#include <cmath>
#include <vector>

namespace gonogo::sim::elastic {

inline constexpr int kBranches = 3;
inline constexpr std::array<double, kBranches> kRate{50, 500, 5000};  // [1/s]

struct Rubber {
  double branch = 0;                                                    // g [-]
  double settled = 1;                                                   // K_0 / K [-]
  double sudden() const { return settled * (1 + kBranches * branch); }  // stiffness of the first instant over K
};

/// Storage and loss modulus over K_0 at the angular frequency w [rad/s].
struct Moduli {
  double storage = 1, loss = 0;
};
inline Moduli moduli_of(double branch, double w) {
  Moduli m;
  for (const double rate : kRate) {
    const double x = w / rate;
    m.storage += branch * x * x / (1 + x * x);
    m.loss += branch * x / (1 + x * x);
  }
  return m;
}

/// For a loss factor below 0.4.
inline Rubber rubber_of(double loss) {
  const Moduli unit = moduli_of(1, kRate[1]);
  Rubber r;
  r.branch = loss / (unit.loss - loss * (unit.storage - 1));
  r.settled = 1 / moduli_of(r.branch, kRate[1]).storage;
  return r;
}

/// Share of a branch's stretch that is left after a step h, and the share of a steady stretching that it takes up.
struct Fading {
  double kept = 1, taken = 1;
};
inline Fading fading_of(double rate, double h) {
  const double kept = std::exp(-rate * h);
  return {kept, h > 0 ? (1 - kept) / (rate * h) : 1};
}

// A tread with loss: at every node a spring with Maxwell branches between the belt and the tread's surface.
// The surface lies on the ground where it is pressed. Elsewhere nothing presses it, and it recovers: its compression s
// and the stretches d of the branches keep s + g sum d = 0 until the ground reaches it again.

class LossyTread {
 public:
  LossyTread() = default;
  /// `stiffness` of the tread of one node at the middle rate [N/m].
  LossyTread(int nodes, double stiffness, const Rubber& rubber);
  /// Takes the compressions of a step h from the gaps of the nodes. Returns what is lost [J].
  double follow(const std::vector<double>& gap, double h);
  /// Force over stiffness, at least 0, one per node [m].
  const std::vector<double>& pressing() const { return pressing_; }
  double energy() const;  // [J]

 private:
  double stiffness_ = 0;
  Rubber rubber_;
  std::vector<double> compression_, pressing_;            // [m]
  std::vector<std::array<double, kBranches>> stretched_;  // [m]
};

}  // namespace gonogo::sim::elastic
