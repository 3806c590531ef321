// Shared by posterior.cpp and joint.cpp.
#pragma once
#include <cstddef>
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

/// e^kMaxLog times any number of terms is finite in double; e^-kMaxLog is not 0.
inline constexpr double kMaxLog = 600;

/// All combinations of bins of some variables, several at a time. The last block is filled up with weight 0.
template <class Real>
struct Posterior::LaneBlocks {
  std::size_t count = 0;      // blocks
  std::vector<Real> inverse;  // exp(-field) [block][hidden][lane]
  std::vector<Real> weight;   // [block][lane]
};

struct Posterior::Summation {
  std::vector<std::size_t> unknown, outer;  // variables; `outer`: the first of them, which are outside the blocks
  LaneBlocks<double> inner;
  std::optional<LaneBlocks<float>> single;  // the same in single precision, where that may do
  FieldRange unknown_range;                 // of what all unknown variables give
  std::vector<double> part;                 // largest size of the blocks' fields [hidden count]
};

/// Index k with probability[k]. u: uniform in [0, 1).
inline std::size_t draw(std::span<const double> probability, double u) {
  std::size_t k = 0;
  for (double sum = probability[0]; k + 1 < probability.size() && u >= sum;) sum += probability[++k];
  return k;
}

/// Visits all combinations of bins of several variables. The last variable changes fastest, so that results of the
/// first ones are computed once for all combinations that share them.
///
/// bins: number of bins of each variable, at least 1. For every combination calls set(k, bin) for the first variable k
/// that changed and all after it, in order, then visit().
template <class Set, class Visit>
void for_each_combination(std::span<const std::size_t> bins, Set&& set, Visit&& visit) {
  std::vector<std::size_t> bin(bins.size(), 0);
  for (std::size_t k = 0;;) {
    for (; k < bins.size(); ++k) set(k, bin[k]);
    visit();
    while (k > 0 && ++bin[k - 1] == bins[k - 1]) bin[--k] = 0;
    if (k == 0) return;
    --k;
  }
}

}  // namespace gonogo::learning
