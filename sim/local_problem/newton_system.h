// How an interior point method solves Newton's systems. Inside sim/local_problem.
#pragma once
#include <Eigen/Sparse>
#include <ctime>
#include <memory>

#include "sim/local_problem/scaled_problem.h"
#include "sim/local_problem/solve.h"

namespace gonogo::sim {

/// Processor time.
inline double ms_since(std::clock_t start) { return 1000.0 * double(std::clock() - start) / CLOCKS_PER_SEC; }

class NewtonSystem {
 public:
  virtual ~NewtonSystem() = default;
  /// Of the matrix w + cones, cones having a diagonal block per contact. False when it cannot be factorised.
  virtual bool factorise(const Eigen::SparseMatrix<double>& w, const Eigen::SparseMatrix<double>& cones) = 0;
  /// False when no solution was found.
  virtual bool solve(const Eigen::VectorXd& rhs, Eigen::VectorXd& x) = 0;
  /// Without solves and times where the caller may as well take them.
  virtual LinearWork work() const { return {}; }
};

/// For the pdip of this name; see solve.h. Direct ones: L D L^T by fronts when `is_symmetric`, otherwise sparse LU.
/// `of`: the problem as scaled; `fixed`: 1 for rows that stay 0.
std::unique_ptr<NewtonSystem> make_newton_system(LocalSolver solver, bool is_symmetric, const LocalProblem& problem,
                                                 const ScaledProblem& of, const std::vector<char>& fixed);

}  // namespace gonogo::sim
