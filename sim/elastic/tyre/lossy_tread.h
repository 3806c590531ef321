// A tread with loss: at every node a spring with Maxwell branches (loss.h) between the belt and the tread's surface.
// The surface lies on the ground where it is pressed. Elsewhere nothing presses it, and it recovers: its compression s
// and the stretches d of the branches keep s + g sum d = 0 until the ground reaches it again.
#pragma once
#include <array>
#include <vector>

#include "sim/elastic/tyre/loss.h"

namespace gonogo::sim::elastic {

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
