// Pairs of a vertical and a horizontal line of the same number, joined where they cross.
#pragma once
#include <array>
#include <vector>

#include "learning/hardware/graph.h"

namespace gonogo::learning {

/// The two arms of a chain, each from end to end.
struct Cross {
  std::array<std::vector<Qubit>, 2> arm;  // vertical, horizontal
  Qubit joint[2] = {0, 0};                // the coupled qubits of the two arms
};

/// The longest cross of every number of lines that has one, in the order of lines.
std::vector<Cross> crosses(const HardwareGraph& graph);

}  // namespace gonogo::learning
