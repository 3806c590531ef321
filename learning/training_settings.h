// How a machine is trained; learning/rbm/train.h says what the symbols mean, docs/learning.md why these defaults.
#pragma once
#include <cstdint>

namespace gonogo::learning {

struct TrainingSettings {
  std::size_t hidden = 8;
  std::size_t epochs = 400;       // most passes over the table
  std::size_t report_every = 10;  // epochs between entries of the log and looks at held-out rows
  std::size_t batch = 32;         // rows of a minibatch
  double learning_rate = 0.02;    // of Adam (Kingma & Ba 2015)
  double discriminative = 1;      // share of the first term; 0 trains a purely generative machine
  double generative = 0.05;       // g
  double weight_decay = 1;        // s [nat]: a prior of variance 1 / s on every weight, whatever the number of rows
  double initial_weight = 0.1;    // standard deviation of the first weights
  std::size_t chains = 64;        // persistent chains of the negative phase
  std::size_t sweeps = 2;         // of every chain between updates
  std::uint64_t seed = 1;
};

}  // namespace gonogo::learning
