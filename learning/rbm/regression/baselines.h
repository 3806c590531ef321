// Baselines of every model, on standardised inputs z: logistic regression, quadratic logistic regression, and a small
// neural network. The fits of all are deterministic.
#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "learning/training.h"

namespace gonogo::learning {

/// z = (x - mean) / standard deviation; 0 for unknown x.
struct Standardisation {
  std::vector<double> mean, scale;  // [variable count], over the known values
  double standardised(std::size_t v, double x) const { return std::isnan(x) ? 0 : (x - mean[v]) / scale[v]; }
};

Standardisation standardisation_of(const TrainingTable& table);

/// What `fit` makes of the rows that are not of fold `without`.
template <class Fit>
auto fit_without(const TrainingTable& table, std::span<const int> label, const std::vector<std::size_t>& fold,
                 std::size_t without, const Fit& fit) {
  std::vector<std::size_t> training;
  std::vector<int> training_label;
  for (std::size_t n = 0; n < fold.size(); ++n) {
    if (fold[n] == without) continue;
    training.push_back(n);
    training_label.push_back(label[n]);
  }
  return fit(table.subset(training), std::span<const int>(training_label));
}

/// Writes the forecast of every row of fold `without` by a model that `fit` makes from the other folds. result: [row].
template <class Fit>
void forecast_fold(const TrainingTable& table, std::span<const int> label, const std::vector<std::size_t>& fold,
                   std::size_t without, const Fit& fit, std::span<double> result) {
  const auto model = fit_without(table, label, fold, without, fit);
  for (std::size_t n = 0; n < fold.size(); ++n)
    if (fold[n] == without) result[n] = model(table.row(n));
}

/// Forecast of every row by a model that `fit` makes from the other folds.
template <class Fit>
std::vector<double> out_of_fold(const TrainingTable& table, std::span<const int> label,
                                const std::vector<std::size_t>& fold, std::size_t fold_count, const Fit& fit) {
  std::vector<double> result(table.row_count());
  for (std::size_t f = 0; f < fold_count; ++f) forecast_fold(table, label, fold, f, fit, result);
  return result;
}

/// P(1 | x) = 1 / (1 + exp(-(c + w.z))).
struct LogisticModel : Standardisation {
  std::vector<double> weight;  // [variable count + 1], the constant last
  double operator()(std::span<const double> variables) const;
  double log_odds(std::span<const double> variables) const;
};

/// Newton's method on the likelihood with the penalty `ridge`/2 |w|^2 [nat], without the constant. label: [row_count()]
/// of {0, 1}.
LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, double ridge = 1.0);

/// What the model adds to log odds that are given, by the same method: P(1 | x) = sigmoid(given + c + w.z). given:
/// [row_count()]; ridge: [variable count + 1] [nat], that of the constant last.
LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, std::span<const double> given,
                           std::span<const double> ridge);

/// Logistic regression on all variables, their squares and their products,
///
///   P(1 | x) = sigmoid(c + sum_i w_i z_i + sum_i,j<=i w_ij z_i z_j).
///
/// Each product is standardised in its turn. A product with an unknown variable counts as its mean.
struct QuadraticModel : Standardisation {
  LogisticModel of_terms;  // over the terms z_1, ..., z_d, z_1 z_1, z_2 z_1, z_2 z_2, z_3 z_1, ...
  double ridge = 0;        // [nat]: chosen by cross-validation
  double operator()(std::span<const double> variables) const;
};

/// Probabilities lie in [1e-12, 1 - 1e-12]. Chooses the ridge among 10^-2.5, 10^-2, ..., 10^1.5 by five-fold
/// cross-validation of the weighted log loss, groups together, then fits on all rows. label: [row_count()] of {0, 1}.
/// Deterministic in the seed.
QuadraticModel fit_quadratic(const TrainingTable& table, std::span<const int> label, std::uint64_t seed = 1);

struct NetworkSettings {
  std::size_t hidden = 16;
  std::size_t max_epochs = 600;  // of Adam on all rows
  double learning_rate = 0.02;
  double weight_decay = 1;  // s [nat]: penalty s / 2 (|A|^2 + |w|^2) of the whole table, as for the machine
  std::uint64_t seed = 1;
};

/// P(1 | x) = sigmoid(c + w . tanh(B + A z)).
struct NetworkModel : Standardisation {
  std::size_t hidden = 0;
  std::vector<double> input_weight, input_bias;  // A [hidden x variable], B [hidden]
  std::vector<double> output_weight;             // w [hidden], then c
  std::size_t epochs = 0;                        // number of epochs trained
  double operator()(std::span<const double> variables) const;
};

/// Chooses the number of epochs on a held-out fifth of the groups, then trains on all rows. label: [row_count()] of
/// {0, 1}. Deterministic in the seed.
NetworkModel fit_network(const TrainingTable& table, std::span<const int> label, const NetworkSettings& settings = {});

}  // namespace gonogo::learning
