// Soft labels that a machine is trained on beside its trials. A teacher, which does better with few trials, says P(1 |
// x) at points without a trial (Hinton, Vinyals, Dean, "Distilling the knowledge in a neural network", 2015). The
// objective of train.h gains, with class c of {0, 1} of every outcome,
//
//   - t mean_k sum_c q_k(c) log P(c | x_k),   P(c | x) = sum of P(y | x) over the outcomes y of class c
//
// so that only the class is taught. Which outcome of a class it is stays with the trials.
#pragma once
#include <cstddef>
#include <vector>

namespace gonogo::learning {

struct Teaching {
  double weight = 0;                // t; 0: no teaching
  std::vector<double> points;       // [point x variable count], all known
  std::vector<double> probability;  // [point]: P(1 | x) by the teacher, in [0, 1]
  std::vector<int> label;           // [outcome]: its class, 0 or 1
};

}  // namespace gonogo::learning
