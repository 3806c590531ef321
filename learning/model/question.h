// What the parts of Posterior share: a question, and drawing from a list of probabilities.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "learning/model/posterior.h"

namespace gonogo::learning {

struct Posterior::Question {
  std::vector<double> field;         // hidden biases and what the known variables add
  std::vector<std::size_t> unknown;  // variables to tell
  std::optional<std::size_t> outcome;
  double terms = 1;  // combinations of bins
};

/// Position k with probability[k]; u: uniform in [0, 1).
inline std::size_t draw(std::span<const double> probability, double u) {
  std::size_t k = 0;
  for (double sum = probability[0]; k + 1 < probability.size() && u >= sum;) sum += probability[++k];
  return k;
}

}  // namespace gonogo::learning
