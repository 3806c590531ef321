// Sums and products by their logarithms.
#pragma once
#include <span>

namespace gonogo::learning {

/// 1 / (1 + exp(-x)).
double sigmoid(double x);
/// log(1 + exp(x)) without overflow.
double softplus(double x);
/// log of a sum of exponentials, without overflow.
double log_sum_exp(std::span<const double> terms);
/// Turns logarithms of weights into probabilities that sum to 1.
void normalise_logs(std::span<double> log_weight);

}  // namespace gonogo::learning
