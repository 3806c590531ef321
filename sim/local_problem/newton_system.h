// How an interior point method solves Newton's systems. Inside sim/local_problem.
#pragma once
#include <Eigen/Sparse>
#include <memory>

#include "sim/local_problem/solve.h"

namespace gonogo::sim {

class NewtonSystem {
 public:
  virtual ~NewtonSystem() = default;
  /// False when it cannot be factorised.
  virtual bool factorise(const Eigen::SparseMatrix<double>& matrix) = 0;
  /// False when no solution was found.
  virtual bool solve(const Eigen::VectorXd& rhs, Eigen::VectorXd& x) = 0;
  virtual LinearWork work() const { return {}; }
};

/// pdip: sparse Cholesky when `is_symmetric`, otherwise sparse LU. pdip_spike: BiCGStab preconditioned by truncated
/// SPIKE. pdip_krylov: BiCGStab alone.
std::unique_ptr<NewtonSystem> make_newton_system(LocalSolver solver, bool is_symmetric);

}  // namespace gonogo::sim
