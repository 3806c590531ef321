// Laplace's approximation of a Gaussian process's posterior, as tensors. Only inside learning/rbm. Equations:
// Rasmussen & Williams (2006), chapters 3 and 5.
#pragma once
#include <span>

#include "learning/rbm/gaussian_process.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {

/// k of every row of a with every row of b. a: [n x variable], b: [m x variable]; result [n x m].
torch::Tensor kernel(const torch::Tensor& a, const torch::Tensor& b, const KernelLogs& logs);

/// The rows' log likelihood sum_n w_n log sigmoid(y_n f_n) at f, with its derivatives, y of {-1, 1}.
struct RowLikelihood {
  torch::Tensor sign, weight;  // y, w [row]
  double value(const torch::Tensor& f) const;
  torch::Tensor slope(const torch::Tensor& f) const;      // d / df
  torch::Tensor curvature(const torch::Tensor& f) const;  // W = -d2 / df2, > 0
  torch::Tensor third(const torch::Tensor& f) const;      // d3 / df3
};

/// The mode of the posterior: f = K a, with root = W^1/2 and lower = the Cholesky factor of B = I + W^1/2 K W^1/2.
struct Mode {
  torch::Tensor f, a, root, lower;
  double log_posterior = 0;  // -1/2 a.f + log likelihood
};
/// Newton's method (algorithm 3.1) from `start` [row], or from 0 if that is undefined. A step that lowers the posterior
/// is halved.
Mode find_mode(const torch::Tensor& K, const RowLikelihood& likelihood, const torch::Tensor& start);

/// Evidence and gradient at a mode (equation 3.32 and algorithm 5.1). Z: [row x variable].
LaplaceEvidence evidence_at(const torch::Tensor& Z, const torch::Tensor& K, const RowLikelihood& likelihood,
                            const Mode& mode, const KernelLogs& logs);

}  // namespace gonogo::learning
