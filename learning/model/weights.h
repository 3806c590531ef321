// A restricted Boltzmann machine: E(v, h) = -a.v - b.h - v' W h with v and h in {0, 1}.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "learning/model/products/logs.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

struct RbmWeights {
  std::size_t visible_count = 0, hidden_count = 0;
  std::vector<double> weight;        // W [visible_count x hidden_count], row by row
  std::vector<double> visible_bias;  // a [visible_count]
  std::vector<double> hidden_bias;   // b [hidden_count]

  static RbmWeights zeros(std::size_t visible, std::size_t hidden);
  bool operator==(const RbmWeights&) const = default;
};

/// F(v) = -a.v - sum_j log(1 + exp(b_j + (v' W)_j)), with P(v) = exp(-F(v)) / Z. v: [visible_count] in [0, 1].
double free_energy(const RbmWeights& weights, std::span<const double> v);

/// The machine as a QUBO, visible variables first: Q_ii = -a_i, Q_jj = -b_j, Q_ij = -W_ij. Keeps couplings of value 0.
/// Labels: the given ones, then "hidden:0", ...
Problem to_qubo(const RbmWeights& weights, const std::vector<std::string>& visible_labels);

}  // namespace gonogo::learning
