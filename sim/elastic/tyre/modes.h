// Small motions of an inflated, unloaded tyre about a rim that is held. Public; free of Eigen.
#pragma once
#include <vector>

#include "sim/elastic/tyre/tyre.h"

namespace gonogo::sim::elastic {

/// Of the belt as a rigid ring on its sidewalls.
struct SidewallStiffness {
  double shift = 0;  // [N/m]
  double turn = 0;   // about the hub [N m/rad]
};
SidewallStiffness sidewall_stiffness(const Tyre& tyre);

/// Frequencies of the ring, ascending [Hz], with the mass matrix of RollingTyre. Throws InputError for a belt without
/// mass. Solved densely: (3 nodes)^3.
std::vector<double> frequencies(const Tyre& tyre);

}  // namespace gonogo::sim::elastic
