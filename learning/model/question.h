// Shared by the .cpp files of Posterior: a question, and a draw from a discrete distribution.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "learning/model/posterior.h"

namespace gonogo::learning {

struct Posterior::Question {
  std::vector<double> field;         // hidden biases plus contributions of the known variables
  std::vector<std::size_t> unknown;  // indices of the unknown variables
  std::optional<std::size_t> outcome;
  double terms = 1;  // number of combinations of bins
};

/// Index k with probability[k]. u: uniform in [0, 1).
inline std::size_t draw(std::span<const double> probability, double u) {
  std::size_t k = 0;
  for (double sum = probability[0]; k + 1 < probability.size() && u >= sum;) sum += probability[++k];
  return k;
}

}  // namespace gonogo::learning
