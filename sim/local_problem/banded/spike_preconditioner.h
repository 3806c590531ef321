// BiCGStab of Eigen on a sparse matrix, preconditioned by SPIKE on its band in the order of reverse Cuthill-McKee.
#pragma once
#include <Eigen/Sparse>
#include <memory>
#include <vector>

#include "sim/local_problem/banded/spike.h"

namespace gonogo::sim {

struct PreconditionerSettings {
  SpikeSettings spike{8, SpikeKind::truncated};
  Eigen::Index most_half = 96;  // half-bandwidth kept; entries farther from the diagonal are dropped
  bool is_single = true;        // factors in float
  bool is_used = true;          // false: the plain Krylov method
  double tolerance = 1e-10;     // |b - A x| / |b|
  int max_iterations = 1000;
};

struct KrylovWork {
  long solves = 0, inner_iterations = 0;
  double setup_ms = 0, solve_ms = 0;  // ordering and factors; iterations
  std::size_t bytes = 0;              // of the largest factors
  Eigen::Index half = 0, full_half = 0;
  int partitions = 0;
  double dropped = 0;  // largest share of a matrix's Frobenius norm outside of the band
};

/// Systems with one pattern: it is ordered once.
class PreconditionedKrylov {
 public:
  explicit PreconditionedKrylov(const PreconditionerSettings& settings);
  ~PreconditionedKrylov();

  void factorise(const Eigen::SparseMatrix<double>& a);
  /// Returns whether the tolerance was reached; x is the last iterate.
  bool solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);
  const KrylovWork& work() const { return work_; }

 private:
  struct Factors;
  PreconditionerSettings settings_;
  Eigen::SparseMatrix<double> a_;
  std::vector<Eigen::Index> order_;
  std::unique_ptr<Factors> factors_;
  KrylovWork work_;
};

}  // namespace gonogo::sim
