// Logistic regression on LibTorch, the first baseline of every model.
//   P(1 | x) = 1 / (1 + exp(-(c + w.z))),  z = (x - mean) / standard deviation, unknown x: z = 0
#pragma once
#include <span>
#include <vector>

#include "learning/rbm/standardise.h"

namespace gonogo::learning {

struct LogisticModel : Standardisation {
  std::vector<double> weight;  // [variable count + 1], the constant last
  double operator()(std::span<const double> variables) const;
};

/// Newton's method on the likelihood with the penalty `ridge`/2 |w|^2 [nat], without the constant. label: [row_count()]
/// of {0, 1}.
LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, double ridge = 1.0);

/// P(1) of every row by a model fitted without the row's fold.
std::vector<double> cross_validate_logistic(const TrainingTable& table, std::span<const int> label,
                                            const std::vector<std::size_t>& fold, std::size_t fold_count,
                                            double ridge = 1.0);

}  // namespace gonogo::learning
