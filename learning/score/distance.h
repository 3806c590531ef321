// Distances between two tables of bins.
#pragma once
#include <vector>

#include "learning/score/boosted_trees.h"

namespace gonogo::learning {

/// Total variation, half the sum of |share in a - share in b| over all cells: 0 for equal tables, at most 1.
struct TableDistance {
  double mean = 0, largest = 0;
  std::size_t largest_a = 0, largest_b = 0;  // columns of the largest one; equal for a single column
};

/// Over single columns, and over all pairs of columns. Values of the columns are bins: whole numbers from 0.
TableDistance marginal_distance(const ScoredRows& a, const ScoredRows& b);
TableDistance pair_distance(const ScoredRows& a, const ScoredRows& b);

}  // namespace gonogo::learning
