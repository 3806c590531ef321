// A machine with 4 visible and 3 hidden units whose every answer is known to twelve digits from an enumeration written
// in another language.
#pragma once
#include "learning/model/weights.h"

namespace gonogo::learning {

inline RbmWeights toy_machine() {
  RbmWeights toy = RbmWeights::zeros(4, 3);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j) toy.weight[3 * std::size_t(i) + std::size_t(j)] = ((7 * i + 3 * j) % 5 - 2) / 4.0;
  toy.visible_bias = {-0.375, -0.125, 0.125, 0.375};
  toy.hidden_bias = {-0.25, 0, 0.25};
  return toy;
}

inline std::vector<std::string> toy_labels() { return {"a", "b", "c", "d"}; }

}  // namespace gonogo::learning
