// A small neural network on LibTorch, the second baseline:
//   P(1 | x) = sigmoid(c + w . tanh(B + A z)),  z as in standardise.h
#pragma once
#include <cstdint>
#include <span>

#include "learning/rbm/standardise.h"

namespace gonogo::learning {

struct NetworkSettings {
  std::size_t hidden = 16;
  std::size_t max_epochs = 600;  // of Adam on all rows
  double learning_rate = 0.02;
  double weight_decay = 1;  // s [nat]: penalty s / 2 (|A|^2 + |w|^2) of the whole table, as for the machine
  std::uint64_t seed = 1;
};

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

/// P(1) of every row by a network fitted without the row's fold.
std::vector<double> cross_validate_network(const TrainingTable& table, std::span<const int> label,
                                           const std::vector<std::size_t>& fold, std::size_t fold_count,
                                           const NetworkSettings& settings = {});

}  // namespace gonogo::learning
