// The inverse of a symmetric positive definite tensor train as a tensor train, by alternating minimisation of
// tr(X^T A X) / 2 - tr X over two neighbouring cores at a time (density matrix renormalisation; Oseledets & Dolgov
// 2012, section 4, as used by Corona, Rahimian & Zorin 2017).
#pragma once
#include "sim/local_problem/tensor_train/tensor_train.h"

namespace gonogo::sim {

struct TtInverseSettings {
  double tolerance = 1e-3;     // of each split of two cores, relative to them
  Eigen::Index max_rank = 12;  // local systems have up to 4 max_rank^2 unknowns
  int max_sweeps = 4;          // to the leaves and back
};

struct TtInverse {
  TtMatrix x;
  double residual = 0;  // |A X v - v| / |v| for a fixed v of ones with changing signs
  int sweeps = 0;
};

/// `start`: an inverse of a matrix nearby, or the identity. Ends where the residual is below the tolerance or no longer
/// halves.
TtInverse invert(const TtMatrix& a, const TtMatrix& start, const TtInverseSettings& settings);

}  // namespace gonogo::sim
