// Linear complementarity problems, and four methods for them:
//
//   w = M x + q,   0 <= x  orthogonal to  w >= 0
//
//   lemke      complementary pivots (Lemke 1965), ties by the lexicographic rule: no basis comes twice. Finite; solves
//              whatever has a copositive-plus M, and contact problems by Stewart & Trinkle (Anitescu & Potra 1997)
//   pgs        projected Gauss-Seidel (Cryer 1971): needs a positive diagonal; converges for symmetric positive M
//   fb_newton  semismooth Newton on the function of Fischer & Burmeister, Armijo's line search, gradients where
//              Newton's direction fails (De Luca, Facchinei & Kanzow 1996); for M of class P0
//   qp         min 1/2 x M x + q x, x >= 0, by active sets (Lawson & Hanson 1974) with M symmetric positive
//              semidefinite; finite
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>

namespace gonogo::sim {

struct Lcp {
  Eigen::SparseMatrix<double, Eigen::RowMajor> m;  // [n x n]
  Eigen::VectorXd q;                               // [n]
  Eigen::Index size() const { return q.size(); }
};

enum class LcpStatus {
  solved,      // the natural error is at or below the tolerance
  iterations,  // the limit came first; x is the best found
  ray,         // lemke: a secondary ray; qp: unbounded. No solution exists where M is copositive plus
};

struct LcpSettings {
  double tolerance = 1e-10;  // of natural_error
  int max_iterations = 0;    // pivots, sweeps or steps; 0: the method's own
};

struct LcpSolution {
  Eigen::VectorXd x;  // [n], >= 0
  double error = 0;   // natural_error of x
  int iterations = 0;
  LcpStatus status = LcpStatus::iterations;
};

/// | min(x, M x + q) | / max(|q|, 1e-300), Euclidean: 0 at a solution alone.
double natural_error(const Lcp& lcp, const Eigen::VectorXd& x);

LcpSolution solve_lemke(const Lcp& lcp, const LcpSettings& settings = {});
/// Rows whose diagonal is not positive keep x = 0. `start` [n]: where it begins; empty: 0.
LcpSolution solve_pgs(const Lcp& lcp, const LcpSettings& settings = {}, const Eigen::VectorXd& start = {});
LcpSolution solve_fb_newton(const Lcp& lcp, const LcpSettings& settings = {});
/// M must be symmetric. `start` [n] >= 0: where it begins, with columns M(:, i), x_i > 0, independent; empty: 0.
LcpSolution solve_qp(const Lcp& lcp, const LcpSettings& settings = {}, const Eigen::VectorXd& start = {});

}  // namespace gonogo::sim
