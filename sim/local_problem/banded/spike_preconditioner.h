// BiCGStab of Eigen on a sparse matrix, preconditioned by SPIKE on its band in the order of reverse Cuthill-McKee.
#pragma once
#include <Eigen/Sparse>
#include <memory>
#include <vector>

#include "sim/local_problem/banded/band_factors.h"
#include "sim/local_problem/banded/spike.h"
#include "sim/local_problem/problem.h"

namespace gonogo::sim {

/// Row of each place, by reverse Cuthill-McKee on the pattern of A + A^T (Boost.Graph). A: square.
std::vector<Eigen::Index> reverse_cuthill_mckee(const Eigen::SparseMatrix<double>& a);

struct Band {
  BandedMatrix<double> matrix;
  Eigen::Index full_half = 0;  // half-bandwidth in this order with nothing dropped
  double dropped = 0;          // share of the Frobenius norm outside of the band that is kept
};

/// P A P^T with entries more than `most_half` from the diagonal dropped.
Band to_band(const Eigen::SparseMatrix<double>& a, const std::vector<Eigen::Index>& order, Eigen::Index most_half);

struct PreconditionerSettings {
  SpikeSettings spike{8, SpikeKind::truncated};
  Eigen::Index most_half = 96;  // half-bandwidth kept; entries farther from the diagonal are dropped
  bool is_single = true;        // factors in float
  bool is_used = true;          // false: the plain Krylov method
  double tolerance = 1e-10;     // |b - A x| / |b|
  int max_iterations = 1000;
};

/// Systems with one pattern: it is ordered once.
class PreconditionedKrylov {
 public:
  explicit PreconditionedKrylov(const PreconditionerSettings& settings);
  ~PreconditionedKrylov();

  void factorise(const Eigen::SparseMatrix<double>& a);
  /// Returns whether the tolerance was reached; x is the last iterate.
  bool solve(const Eigen::VectorXd& b, Eigen::VectorXd& x);
  const LinearWork& work() const { return work_; }

 private:
  struct Factors;
  PreconditionerSettings settings_;
  Eigen::SparseMatrix<double> a_;
  std::vector<Eigen::Index> order_;
  std::unique_ptr<Factors> factors_;
  LinearWork work_;
};

}  // namespace gonogo::sim
