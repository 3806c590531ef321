// A problem whose variables fall into two sides without couplings inside a side: given one side, the variables of the
// other are independent. Dense storage: the problems of restricted Boltzmann machines.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// E(x) = offset - bias_left.l - bias_right.r - l' W r with x in {0, 1}: the signs of a Boltzmann machine.
struct Bipartite {
  std::vector<std::uint32_t> left, right;  // positions of the variables in the problem
  std::vector<double> bias_left, bias_right;
  std::vector<double> weight;            // [left x right], row by row
  std::vector<double> weight_transpose;  // [right x left]
  double offset = 0;
};

/// Two-colours a problem in {0, 1}; nothing when it has an odd cycle. In each connected part the lowest variable goes
/// left, except that a variable without couplings goes right.
std::optional<Bipartite> split_in_two(const Problem& qubo);

}  // namespace gonogo::learning
