// How an interior point method solves Newton's systems.
#pragma once
#include <Eigen/Sparse>
#include <ctime>
#include <memory>

#include "sim/local_problem/algebra/scaled_problem.h"

namespace gonogo::sim {

/// Processor time.
inline double ms_since(std::clock_t start) { return 1000.0 * double(std::clock() - start) / CLOCKS_PER_SEC; }

class NewtonSystem {
 public:
  virtual ~NewtonSystem() = default;
  /// Factorises w + cones, where cones has a diagonal block per contact. False when it cannot be factorised.
  virtual bool factorise(const Eigen::SparseMatrix<double>& w, const Eigen::SparseMatrix<double>& cones) = 0;
  /// False when no solution was found.
  virtual bool solve(const Eigen::VectorXd& rhs, Eigen::VectorXd& x) = 0;
  /// Without solves and times where the caller may as well take them.
  virtual LinearWork work() const { return {}; }
};

enum class NewtonKind {
  direct,       // L D L^T by fronts, hubs set apart, where the matrix is symmetric; otherwise sparse LU
  bodies,       // over bodies in place of contacts; needs bodies
  spike,        // BiCGStab preconditioned by truncated SPIKE
  krylov,       // BiCGStab alone
  blocks,       // conjugate gradients on contacts' blocks scaled to 1; W symmetric
  tensor_train  // the same, preconditioned by an inverse as a tensor train
};

/// `of`: the problem as scaled; `fixed`: 1 for rows that stay 0.
std::unique_ptr<NewtonSystem> make_newton_system(NewtonKind kind, bool is_symmetric, const LocalProblem& problem,
                                                 const ScaledProblem& of, const std::vector<char>& fixed);

}  // namespace gonogo::sim
