#include "learning/model/products/logs.h"

#include <algorithm>
#include <cmath>

namespace gonogo::learning {

double sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

double log_sum_exp(std::span<const double> terms) {
  const double highest = *std::max_element(terms.begin(), terms.end());
  double sum = 0;
  for (double term : terms) sum += std::exp(term - highest);
  return highest + std::log(sum);
}

void normalise_logs(std::span<double> log_weight) {
  const double total = log_sum_exp(log_weight);
  for (double& x : log_weight) x = std::exp(x - total);
}

}  // namespace gonogo::learning
