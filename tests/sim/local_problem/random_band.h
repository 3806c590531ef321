// A banded matrix of random numbers.
#pragma once
#include <algorithm>
#include <cmath>
#include <random>

#include "sim/local_problem/banded/band_factors.h"

namespace gonogo::sim {

/// |a_ii| = dominance times the sum of the others in the row.
inline BandedMatrix<double> random_band(unsigned seed, Eigen::Index n, Eigen::Index half, double dominance) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BandedMatrix<double> a(n, half);
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = 0;
    for (Eigen::Index j = std::max<Eigen::Index>(0, i - half); j <= std::min(n - 1, i + half); ++j)
      if (i != j) sum += std::abs(a.at(i, j) = uniform(generator));
    a.at(i, i) = (uniform(generator) < 0 ? -1 : 1) * dominance * std::max(sum, 0.5);
  }
  return a;
}

}  // namespace gonogo::sim
