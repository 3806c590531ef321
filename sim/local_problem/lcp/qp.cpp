// The unknowns that may be positive form a set whose block of M is regular; a triangular factor of it grows by a row
// and shrinks by rotations. An unknown that would make the block singular moves along the null direction instead, until
// another one reaches 0 and leaves.
#include <Eigen/Jacobi>
#include <cmath>
#include <vector>

#include "base/cancel.h"
#include "sim/local_problem/lcp/lcp.h"

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Cholesky's factor L of the block of M over `set`.
class Factor {
 public:
  explicit Factor(const MatrixXd& m) : m_(m), l_(m.rows(), m.cols()) {}

  const std::vector<Index>& set() const { return set_; }
  Index size() const { return Index(set_.size()); }

  VectorXd column(Index j) const {
    VectorXd c(size());
    for (Index a = 0; a < size(); ++a) c[a] = m_(set_[a], j);
    return c;
  }
  VectorXd solve(VectorXd rhs) const {
    const auto l = l_.topLeftCorner(size(), size());
    l.triangularView<Eigen::Lower>().solveInPlace(rhs);
    l.transpose().triangularView<Eigen::Upper>().solveInPlace(rhs);
    return rhs;
  }

  /// False, and no change, where the block would be singular.
  bool append(Index j) {
    VectorXd row = column(j);
    const Index n = size();
    l_.topLeftCorner(n, n).triangularView<Eigen::Lower>().solveInPlace(row);
    const double rest = m_(j, j) - row.squaredNorm();
    if (!(rest > 1e-12 * m_(j, j))) return false;
    l_.row(n).head(n) = row.transpose();
    l_(n, n) = std::sqrt(rest);
    set_.push_back(j);
    return true;
  }

  void remove(Index place) {
    const Index n = size();
    for (Index i = place; i + 1 < n; ++i) l_.row(i).head(i + 2) = l_.row(i + 1).head(i + 2);
    for (Index k = place; k + 1 < n; ++k) {
      Eigen::JacobiRotation<double> rotation;
      rotation.makeGivens(l_(k, k), l_(k, k + 1));
      l_.block(k, 0, n - 1 - k, n).applyOnTheRight(k, k + 1, rotation);
      if (l_(k, k) < 0) l_.col(k).segment(k, n - 1 - k) *= -1;
    }
    set_.erase(set_.begin() + place);
  }

 private:
  const MatrixXd& m_;
  MatrixXd l_;
  std::vector<Index> set_;
};

class ActiveSet {
 public:
  ActiveSet(const Lcp& lcp, const VectorXd& start) : m_(lcp.m), q_(lcp.q), factor_(m_), x_(VectorXd::Zero(lcp.size())) {
    for (Index i = 0; i < start.size(); ++i)
      if (start[i] > 0 && factor_.append(i)) x_[i] = start[i];
    if (factor_.size() > 0) descend();
  }

  const VectorXd& x() const { return x_; }

  enum class Outcome { moved, optimal, unbounded };
  Outcome step() {
    const VectorXd gradient = m_ * x_ + q_;
    const double noise = 1e-14 * (q_.lpNorm<Eigen::Infinity>() + m_.diagonal().maxCoeff() * x_.lpNorm<1>());
    Index entering = -1;
    for (Index i = 0; i < x_.size(); ++i)
      if (x_[i] == 0 && gradient[i] < -noise && (entering < 0 || gradient[i] < gradient[entering])) entering = i;
    if (entering < 0) return Outcome::optimal;
    while (!factor_.append(entering))
      if (!move_along_null(entering)) return Outcome::unbounded;
    descend();
    return Outcome::moved;
  }

 private:
  /// To the minimum over the set, or to the first bounds on the way; these leave the set.
  void descend() {
    while (factor_.size() > 0) {
      VectorXd rhs(factor_.size());
      for (Index a = 0; a < rhs.size(); ++a) rhs[a] = -q_[factor_.set()[a]];
      const VectorXd target = factor_.solve(rhs);
      double t = 1;
      Index blocking = -1;
      for (Index a = 0; a < target.size(); ++a)
        if (const double from = x_[factor_.set()[a]]; target[a] <= 0 && from / (from - target[a]) < t)
          t = from / (from - target[a]), blocking = a;
      for (Index a = 0; a < target.size(); ++a) {
        double& value = x_[factor_.set()[a]];
        value += t * (target[a] - value);
      }
      if (blocking < 0) return;
      drop(blocking);
    }
  }

  /// M is constant along (entering: 1, set: -block^-1 column), the objective falls. False when nothing blocks.
  bool move_along_null(Index entering) {
    const VectorXd d = -factor_.solve(factor_.column(entering));
    double t = -1;
    Index blocking = -1;
    for (Index a = 0; a < d.size(); ++a)
      if (const double limit = -x_[factor_.set()[a]] / d[a]; d[a] < 0 && (blocking < 0 || limit < t))
        t = limit, blocking = a;
    if (blocking < 0) return false;
    x_[entering] += t;
    for (Index a = 0; a < d.size(); ++a) x_[factor_.set()[a]] += t * d[a];
    drop(blocking);
    return true;
  }

  void drop(Index place) {
    x_[factor_.set()[place]] = 0;
    factor_.remove(place);
  }

  MatrixXd m_;
  VectorXd q_;
  Factor factor_;
  VectorXd x_;
};

}  // namespace

LcpSolution solve_qp(const Lcp& lcp, const LcpSettings& settings, const VectorXd& start) {
  const int max = settings.max_iterations > 0 ? settings.max_iterations : int(20 * lcp.size() + 100);
  ActiveSet method(lcp, start);
  LcpSolution solution;
  auto outcome = ActiveSet::Outcome::moved;
  while (outcome == ActiveSet::Outcome::moved && solution.iterations < max) {
    stop_if_cancelled();
    outcome = method.step();
    solution.iterations += outcome == ActiveSet::Outcome::moved;
  }
  solution.x = method.x().cwiseMax(0.0);
  solution.error = natural_error(lcp, solution.x);
  if (solution.error <= settings.tolerance)
    solution.status = LcpStatus::solved;
  else if (outcome == ActiveSet::Outcome::unbounded)
    solution.status = LcpStatus::ray;
  return solution;
}

}  // namespace gonogo::sim
