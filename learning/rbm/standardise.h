// Standardised inputs of the baselines: (x - mean) / standard deviation; 0 for unknown x.
#pragma once
#include <cmath>
#include <span>
#include <vector>

#include "learning/table.h"

namespace gonogo::learning {

struct Standardisation {
  std::vector<double> mean, scale;  // [variable count], over the known values
  double standardised(std::size_t v, double x) const { return std::isnan(x) ? 0 : (x - mean[v]) / scale[v]; }
};

Standardisation standardisation_of(const TrainingTable& table);

/// Forecast of every row by a model that `fit` makes from the other folds.
template <class Fit>
std::vector<double> out_of_fold(const TrainingTable& table, std::span<const int> label,
                                const std::vector<std::size_t>& fold, std::size_t fold_count, Fit fit) {
  std::vector<double> result(table.row_count());
  for (std::size_t f = 0; f < fold_count; ++f) {
    std::vector<std::size_t> training;
    std::vector<int> training_label;
    for (std::size_t n = 0; n < fold.size(); ++n) {
      if (fold[n] == f) continue;
      training.push_back(n);
      training_label.push_back(label[n]);
    }
    const auto model = fit(table.subset(training), std::span<const int>(training_label));
    for (std::size_t n = 0; n < fold.size(); ++n)
      if (fold[n] == f) result[n] = model(table.row(n));
  }
  return result;
}

}  // namespace gonogo::learning
