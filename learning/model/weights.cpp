#include "learning/model/weights.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::learning {

RbmWeights RbmWeights::zeros(std::size_t visible, std::size_t hidden) {
  return {.visible_count = visible,
          .hidden_count = hidden,
          .weight = std::vector<double>(visible * hidden),
          .visible_bias = std::vector<double>(visible),
          .hidden_bias = std::vector<double>(hidden)};
}

double free_energy(const RbmWeights& weights, std::span<const double> v) {
  GONOGO_ASSERT(v.size() == weights.visible_count);
  std::vector<double> field = weights.hidden_bias;
  double result = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (v[i] == 0) continue;
    result -= weights.visible_bias[i] * v[i];
    for (std::size_t j = 0; j < field.size(); ++j) field[j] += v[i] * weights.weight[i * field.size() + j];
  }
  for (double f : field) result -= softplus(f);
  return result;
}

Problem to_qubo(const RbmWeights& weights, const std::vector<std::string>& visible_labels) {
  GONOGO_ASSERT(visible_labels.size() == weights.visible_count);
  Problem problem;
  problem.labels.assign(visible_labels.begin(), visible_labels.end());
  for (std::size_t j = 0; j < weights.hidden_count; ++j) problem.labels.push_back("hidden:" + std::to_string(j));
  for (double bias : weights.visible_bias) problem.linear.push_back(-bias);
  for (double bias : weights.hidden_bias) problem.linear.push_back(-bias);
  for (std::size_t i = 0; i < weights.visible_count; ++i)
    for (std::size_t j = 0; j < weights.hidden_count; ++j)
      problem.couplings.push_back(
          {std::uint32_t(i), std::uint32_t(weights.visible_count + j), -weights.weight[i * weights.hidden_count + j]});
  return problem;
}

}  // namespace gonogo::learning
