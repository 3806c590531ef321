// Gaussian copula of a table: every column has its own distribution, and the columns' normal scores are jointly normal
// (Nelsen, An Introduction to Copulas, 2006, section 2.3). The baseline of a joint distribution. Columns of a few
// values, as the number of an outcome, are steps of a latent normal variable, so their order matters.
#pragma once
#include <cstdint>
#include <vector>

#include "learning/score/two_sample.h"

namespace gonogo::learning {

class GaussianCopula {
 public:
  /// Ranks of ties are spread at random by `seed`. Throws InputError with fewer than two rows.
  GaussianCopula(const ScoredRows& rows, std::uint64_t seed);
  /// Rows of weight 1. A column's values are those that it had; between neighbours of a column of more than
  /// kMaxSteps values they are interpolated.
  ScoredRows draw(std::size_t count, std::uint64_t seed) const;
  /// Correlation of the normal scores of two columns.
  double correlation(std::size_t a, std::size_t b) const { return correlation_[a * columns_ + b]; }

  static constexpr std::size_t kMaxSteps = 32;

 private:
  double quantile(std::size_t column, double u) const;
  std::size_t columns_;
  std::vector<std::vector<double>> value_, until_;  // [column] sorted values, and the share of rows up to each
  std::vector<char> steps_;                         // [column] whether it has few values
  std::vector<double> correlation_, root_;          // [column x column], and its Cholesky factor
};

}  // namespace gonogo::learning
