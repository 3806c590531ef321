#include "sim/local_problem/algebra/lcp.h"

#include <Eigen/Jacobi>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/progress.h"

namespace gonogo::sim {

double natural_error(const Lcp& lcp, const Eigen::VectorXd& x) {
  return x.cwiseMin(lcp.m * x + lcp.q).norm() / std::max(lcp.q.norm(), 1e-300);
}

// Dictionary of Lemke's method: each basic variable is a constant plus a linear form in the nonbasic ones,
//
//   x_B = c + T x_N,   at first  w = q + M z + 1 z0
//
// The lexicographic rule acts as if q_i were q_i + eps^(i + 1) for a small eps. A row of the inverse basis tells how
// its constant then changes: it stands, with its sign turned, in the columns of nonbasic w (Cottle, Pang & Stone
// 1992, 4.9).

namespace {

using Eigen::VectorXd;

class Dictionary {
 public:
  explicit Dictionary(const Lcp& lcp)
      : n_(lcp.size()), t_(n_, n_ + 2), basic_(n_), nonbasic_(n_ + 1), place_(2 * n_ + 1) {
    t_.leftCols(n_) = Eigen::MatrixXd(lcp.m);
    t_.col(n_).setOnes();
    t_.col(constant()) = lcp.q;
    for (Eigen::Index i = 0; i < n_; ++i) set_basic(i, i);
    for (Eigen::Index j = 0; j <= n_; ++j) set_nonbasic(j, n_ + j);
  }

  Eigen::Index z0() const { return 2 * n_; }
  Eigen::Index complement(Eigen::Index variable) const { return variable < n_ ? variable + n_ : variable - n_; }

  /// Row to leave for the first step, in which z0 enters: the lexicographically lowest constant.
  Eigen::Index lowest_row() const {
    Eigen::Index lowest = 0;
    for (Eigen::Index i = 1; i < n_; ++i)
      if (is_before(i, 1, lowest, 1)) lowest = i;
    return lowest;
  }

  /// Row that first reaches 0 as `entering` grows, z0 where it ties; -1: none does.
  Eigen::Index blocking_row(Eigen::Index entering) const {
    const Eigen::Index column = place_[entering];
    const double least = 1e-11 * std::max(1.0, t_.col(column).cwiseAbs().maxCoeff());
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < n_; ++i)
      if (const double slope = -t_(i, column); slope > least)
        if (best < 0 || is_before(i, slope, best, -t_(best, column))) best = i;
    return best;
  }

  /// `entering` becomes basic in `row`; returns the variable that leaves.
  Eigen::Index pivot(Eigen::Index row, Eigen::Index entering) {
    const Eigen::Index column = place_[entering], leaving = basic_[row];
    const double pivot = t_(row, column);
    t_.row(row) /= -pivot;
    t_(row, column) = 1 / pivot;
    const Eigen::RowVectorXd source = t_.row(row);
    for (Eigen::Index i = 0; i < n_; ++i) {
      const double factor = t_(i, column);
      if (i == row || factor == 0) continue;
      t_(i, column) = 0;
      t_.row(i) += factor * source;
    }
    set_basic(row, entering);
    set_nonbasic(column, leaving);
    return leaving;
  }

  VectorXd z() const {
    VectorXd x = VectorXd::Zero(n_);
    for (Eigen::Index i = 0; i < n_; ++i)
      if (basic_[i] >= n_ && basic_[i] < 2 * n_) x[basic_[i] - n_] = std::max(0.0, t_(i, constant()));
    return x;
  }
  std::vector<Eigen::Index> basic_z() const {
    std::vector<Eigen::Index> found;
    for (const Eigen::Index v : basic_)
      if (v >= n_ && v < 2 * n_) found.push_back(v - n_);
    return found;
  }
  double least_constant() const { return t_.col(constant()).minCoeff(); }

 private:
  Eigen::Index constant() const { return n_ + 1; }
  void set_basic(Eigen::Index row, Eigen::Index variable) { place_[basic_[row] = variable] = row; }
  void set_nonbasic(Eigen::Index column, Eigen::Index variable) { place_[nonbasic_[column] = variable] = column; }
  bool is_basic(Eigen::Index variable) const { return place_[variable] < n_ && basic_[place_[variable]] == variable; }

  /// Whether (c_a, inverse basis row a) / slope_a is lexicographically below that of b.
  bool is_before(Eigen::Index a, double slope_a, Eigen::Index b, double slope_b) const {
    const auto compare = [&](double x, double y) {
      const double difference = x / slope_a - y / slope_b;
      return std::abs(difference) <= 1e-12 * (1 + std::abs(x / slope_a)) ? 0 : difference < 0 ? -1 : 1;
    };
    if (const int order = compare(t_(a, constant()), t_(b, constant())); order != 0) return order < 0;
    if (basic_[a] == z0() || basic_[b] == z0()) return basic_[a] == z0();  // the end, when z0 may leave
    for (Eigen::Index j = 0; j < n_; ++j) {
      const bool basic = is_basic(j);
      const double x = basic ? double(place_[j] == a) : -t_(a, place_[j]);
      const double y = basic ? double(place_[j] == b) : -t_(b, place_[j]);
      if (const int order = compare(x, y); order != 0) return order < 0;
    }
    return false;
  }

  Eigen::Index n_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> t_;  // T and, last, c
  std::vector<Eigen::Index> basic_, nonbasic_,
      place_;  // variables: w 0 .. n - 1, z n .. 2n - 1, z0; place: row or column
};

/// The solution of the last basis without the rounding of its pivots, where that is better.
void polish(const Lcp& lcp, const std::vector<Eigen::Index>& basis, LcpSolution& solution) {
  const Eigen::Index size = Eigen::Index(basis.size());
  if (size == 0) return;
  Eigen::MatrixXd block(size, size);
  VectorXd rhs(size);
  for (Eigen::Index a = 0; a < size; ++a) {
    const VectorXd row = lcp.m.row(basis[a]);
    for (Eigen::Index b = 0; b < size; ++b) block(a, b) = row[basis[b]];
    rhs[a] = -lcp.q[basis[a]];
  }
  const VectorXd found = block.partialPivLu().solve(rhs);
  if (!found.allFinite()) return;
  VectorXd x = VectorXd::Zero(lcp.size());
  for (Eigen::Index a = 0; a < size; ++a) x[basis[a]] = std::max(0.0, found[a]);
  const double error = natural_error(lcp, x);
  if (error >= solution.error) return;
  solution.x = x;
  solution.error = error;
}

}  // namespace

LcpSolution solve_lemke(const Lcp& lcp, const LcpSettings& settings) {
  const int max = settings.max_iterations > 0 ? settings.max_iterations : int(50 * lcp.size() + 100);
  LcpSolution solution;
  solution.x = VectorXd::Zero(lcp.size());
  Dictionary dictionary(lcp);
  if (dictionary.least_constant() < 0) {
    Eigen::Index entering = dictionary.z0(), row = dictionary.lowest_row();
    while (row >= 0 && solution.iterations < max) {
      stop_if_cancelled();
      const Eigen::Index leaving = dictionary.pivot(row, entering);
      ++solution.iterations;
      if (leaving == dictionary.z0()) break;
      entering = dictionary.complement(leaving);
      row = dictionary.blocking_row(entering);
    }
    if (row < 0) solution.status = LcpStatus::ray;
    solution.x = dictionary.z();
  }
  solution.error = natural_error(lcp, solution.x);
  polish(lcp, dictionary.basic_z(), solution);
  if (solution.error <= settings.tolerance) solution.status = LcpStatus::solved;
  return solution;
}

LcpSolution solve_pgs(const Lcp& lcp, const LcpSettings& settings, const Eigen::VectorXd& start) {
  constexpr int kCheckEvery = 10;  // sweeps; an error costs as much as a sweep
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 20000;
  const Eigen::VectorXd diagonal = lcp.m.diagonal();
  LcpSolution best;
  best.x = start.size() > 0 ? start : Eigen::VectorXd(Eigen::VectorXd::Zero(lcp.size()));
  best.error = natural_error(lcp, best.x);
  Eigen::VectorXd x = best.x;
  int k = 0;
  while (k < max && best.error > settings.tolerance) {
    stop_if_cancelled();
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (diagonal[i] > 0) x[i] = std::max(0.0, x[i] - (lcp.m.row(i).dot(x) + lcp.q[i]) / diagonal[i]);
    if (++k % kCheckEvery != 0 && k != max) continue;
    const double error = natural_error(lcp, x);
    if (error >= best.error) continue;
    best.error = error;
    best.x = x;
  }
  best.iterations = k;
  best.status = best.error <= settings.tolerance ? LcpStatus::solved : LcpStatus::iterations;
  return best;
}

// phi(a, b) = sqrt(a^2 + b^2) - a - b is 0 exactly where 0 <= a, 0 <= b, a b = 0. Newton's method finds the zero of
// phi(x, M x + q) row by row; the merit 1/2 |phi|^2 is smooth, so that gradients help where Newton's direction fails.

namespace {

using Sparse = Eigen::SparseMatrix<double>;

class FischerBurmeister {
 public:
  explicit FischerBurmeister(const Lcp& lcp) : lcp_(lcp), x_(VectorXd::Zero(lcp.size())) { evaluate(x_); }

  VectorXd point() const { return x_.cwiseMax(0.0); }
  double merit() const { return 0.5 * phi_.squaredNorm(); }

  /// One step; false when no step lowers the merit.
  bool step() {
    const Sparse h = jacobian();
    const VectorXd gradient = h.transpose() * phi_;
    if (!(gradient.norm() > 0)) return false;
    lu_.compute(h);
    if (lu_.info() == Eigen::Success) {
      const VectorXd d = lu_.solve(-phi_);
      const double least = 1e-8 * std::pow(d.norm(), 2.1);
      if (d.allFinite() && gradient.dot(d) <= -least && search(d, gradient.dot(d))) return true;
    }
    return search(-gradient, -gradient.squaredNorm());
  }

 private:
  void evaluate(const VectorXd& x) {
    w_ = lcp_.m * x + lcp_.q;
    phi_.resize(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) phi_[i] = value(x[i], w_[i]);
  }

  /// sqrt(a^2 + b^2) - a - b without cancellation.
  static double value(double a, double b) {
    const double sum = a + b, root = std::hypot(a, b);
    return sum > 0 ? -2 * a * b / (root + sum) : root - sum;
  }

  /// An element of the generalised Jacobian, diag(da) + diag(db) (M + epsilon), where a and b are 0 by the limit along
  /// the ones vector (De Luca et al., 7.1). epsilon falls with the merit and keeps it regular for M of class P0
  /// (Facchinei & Kanzow 1999).
  Sparse jacobian() const {
    const double epsilon = 1e-3 * std::min(1.0, phi_.lpNorm<Eigen::Infinity>());
    VectorXd ones = VectorXd::Zero(x_.size());
    for (Eigen::Index i = 0; i < x_.size(); ++i) ones[i] = x_[i] == 0 && w_[i] == 0;
    const VectorXd along = lcp_.m * ones;
    VectorXd da(x_.size()), db(x_.size());
    for (Eigen::Index i = 0; i < x_.size(); ++i) {
      const double a = ones[i] > 0 ? 1 : x_[i], b = ones[i] > 0 ? along[i] : w_[i], root = std::hypot(a, b);
      da[i] = a / root - 1;
      db[i] = b / root - 1;
    }
    Eigen::SparseMatrix<double, Eigen::RowMajor> h = db.asDiagonal() * lcp_.m;
    Sparse shift(x_.size(), x_.size());
    shift.setIdentity();
    shift = Sparse((da + epsilon * db).asDiagonal() * shift);
    return Sparse(h) + shift;
  }

  /// Armijo's rule along d.
  bool search(const VectorXd& d, double slope) {
    const VectorXd from = x_;
    const double before = merit();
    double t = 1;
    for (int k = 0; k < 40; ++k, t /= 2) {
      x_ = from + t * d;
      evaluate(x_);
      if (merit() <= before + 1e-4 * t * slope) return true;
    }
    x_ = from;
    evaluate(x_);
    return false;
  }

  const Lcp& lcp_;
  VectorXd x_, w_, phi_;
  Eigen::SparseLU<Sparse> lu_;
};

}  // namespace

LcpSolution solve_fb_newton(const Lcp& lcp, const LcpSettings& settings) {
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 500;
  LcpSolution best;
  best.x = VectorXd::Zero(lcp.size());
  best.error = natural_error(lcp, best.x);
  FischerBurmeister method(lcp);
  while (best.iterations < max && best.error > settings.tolerance && method.step()) {
    stop_if_cancelled();
    ++best.iterations;
    const VectorXd x = method.point();
    const double error = natural_error(lcp, x);
    if (error >= best.error) continue;
    best.error = error;
    best.x = x;
  }
  best.status = best.error <= settings.tolerance ? LcpStatus::solved : LcpStatus::iterations;
  return best;
}

// The unknowns that may be positive form a set whose block of M is regular; a triangular factor of it grows by a row
// and shrinks by rotations. An unknown that would make the block singular moves along the null direction instead, until
// another one reaches 0 and leaves.

namespace {

using Eigen::MatrixXd;

/// Cholesky's factor L of the block of M over `set`.
class Factor {
 public:
  explicit Factor(const MatrixXd& m) : m_(m), l_(m.rows(), m.cols()) {}

  const std::vector<Eigen::Index>& set() const { return set_; }
  Eigen::Index size() const { return Eigen::Index(set_.size()); }

  VectorXd column(Eigen::Index j) const {
    VectorXd c(size());
    for (Eigen::Index a = 0; a < size(); ++a) c[a] = m_(set_[a], j);
    return c;
  }
  VectorXd solve(VectorXd rhs) const {
    const auto l = l_.topLeftCorner(size(), size());
    l.triangularView<Eigen::Lower>().solveInPlace(rhs);
    l.transpose().triangularView<Eigen::Upper>().solveInPlace(rhs);
    return rhs;
  }

  /// False, and no change, where the block would be singular.
  bool append(Eigen::Index j) {
    VectorXd row = column(j);
    const Eigen::Index n = size();
    l_.topLeftCorner(n, n).triangularView<Eigen::Lower>().solveInPlace(row);
    const double rest = m_(j, j) - row.squaredNorm();
    if (!(rest > 1e-12 * m_(j, j))) return false;
    l_.row(n).head(n) = row.transpose();
    l_(n, n) = std::sqrt(rest);
    set_.push_back(j);
    return true;
  }

  void remove(Eigen::Index place) {
    const Eigen::Index n = size();
    for (Eigen::Index i = place; i + 1 < n; ++i) l_.row(i).head(i + 2) = l_.row(i + 1).head(i + 2);
    for (Eigen::Index k = place; k + 1 < n; ++k) {
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
  std::vector<Eigen::Index> set_;
};

class ActiveSet {
 public:
  ActiveSet(const Lcp& lcp, const VectorXd& start) : m_(lcp.m), q_(lcp.q), factor_(m_), x_(VectorXd::Zero(lcp.size())) {
    for (Eigen::Index i = 0; i < start.size(); ++i)
      if (start[i] > 0 && factor_.append(i)) x_[i] = start[i];
    if (factor_.size() > 0) descend();
  }

  const VectorXd& x() const { return x_; }

  enum class Outcome { moved, optimal, unbounded };
  Outcome step() {
    const VectorXd gradient = m_ * x_ + q_;
    const double noise = 1e-14 * (q_.lpNorm<Eigen::Infinity>() + m_.diagonal().maxCoeff() * x_.lpNorm<1>());
    Eigen::Index entering = -1;
    for (Eigen::Index i = 0; i < x_.size(); ++i)
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
      for (Eigen::Index a = 0; a < rhs.size(); ++a) rhs[a] = -q_[factor_.set()[a]];
      const VectorXd target = factor_.solve(rhs);
      double t = 1;
      Eigen::Index blocking = -1;
      for (Eigen::Index a = 0; a < target.size(); ++a)
        if (const double from = x_[factor_.set()[a]]; target[a] <= 0 && from / (from - target[a]) < t)
          t = from / (from - target[a]), blocking = a;
      for (Eigen::Index a = 0; a < target.size(); ++a) {
        double& value = x_[factor_.set()[a]];
        value += t * (target[a] - value);
      }
      if (blocking < 0) return;
      drop(blocking);
    }
  }

  /// M is constant along (entering: 1, set: -block^-1 column), the objective falls. False when nothing blocks.
  bool move_along_null(Eigen::Index entering) {
    const VectorXd d = -factor_.solve(factor_.column(entering));
    double t = -1;
    Eigen::Index blocking = -1;
    for (Eigen::Index a = 0; a < d.size(); ++a)
      if (const double limit = -x_[factor_.set()[a]] / d[a]; d[a] < 0 && (blocking < 0 || limit < t))
        t = limit, blocking = a;
    if (blocking < 0) return false;
    x_[entering] += t;
    for (Eigen::Index a = 0; a < d.size(); ++a) x_[factor_.set()[a]] += t * d[a];
    drop(blocking);
    return true;
  }

  void drop(Eigen::Index place) {
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
