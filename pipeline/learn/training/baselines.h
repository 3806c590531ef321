// The baselines that every model is scored beside.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "learning/rbm/gaussian_process.h"
#include "learning/rbm/logistic.h"
#include "learning/rbm/network.h"
#include "learning/rbm/quadratic.h"
#include "learning/table.h"

namespace gonogo::learn {

/// All baselines, fitted to the same trials.
struct Baselines {
  learning::LogisticModel logistic;
  learning::QuadraticModel quadratic;
  learning::GaussianProcessModel process;
  learning::NetworkModel network;
  double base_rate = 0.5;

  /// P(1) of many points by every baseline, by its name in kBaselines. points: [point count x variable count].
  std::map<std::string, std::vector<double>> forecasts(std::span<const double> points) const;
};

/// label: [row_count()] of {0, 1}.
Baselines fit_baselines(const learning::TrainingTable& table, std::span<const int> label);

/// P(1) of every row by baselines fitted without the row's fold. The Gaussian process is not among them: it costs most
/// and may be at hand as a teacher (teacher.h).
std::map<std::string, std::vector<double>> cross_validate_baselines(const learning::TrainingTable& table,
                                                                    std::span<const int> label,
                                                                    const std::vector<std::size_t>& fold,
                                                                    std::size_t fold_count);

}  // namespace gonogo::learn
