// Quadratic logistic regression on LibTorch, a baseline of every model: logistic regression on all variables, their
// squares and their products,
//
//   P(1 | x) = sigmoid(c + sum_i w_i z_i + sum_i,j<=i w_ij z_i z_j),  z as in standardise.h
//
// Each product is standardised in its turn. A product with an unknown variable counts as its mean.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/rbm/logistic.h"

namespace gonogo::learning {

struct QuadraticModel : Standardisation {
  LogisticModel of_terms;  // over the terms z_1, ..., z_d, z_1 z_1, z_2 z_1, z_2 z_2, z_3 z_1, ...
  double ridge = 0;        // [nat]: chosen by cross-validation
  double operator()(std::span<const double> variables) const;
};

/// Probabilities lie in [1e-12, 1 - 1e-12]. Chooses the ridge among 10^-2.5, 10^-2, ..., 10^1.5 by five-fold
/// cross-validation of the weighted log loss, groups together, then fits on all rows. label: [row_count()] of {0, 1}.
/// Deterministic in the seed.
QuadraticModel fit_quadratic(const TrainingTable& table, std::span<const int> label, std::uint64_t seed = 1);

/// P(1) of every row by a model fitted without the row's fold.
std::vector<double> cross_validate_quadratic(const TrainingTable& table, std::span<const int> label,
                                             const std::vector<std::size_t>& fold, std::size_t fold_count);

}  // namespace gonogo::learning
