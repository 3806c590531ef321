// Dictionary of Lemke's method: each basic variable is a constant plus a linear form in the nonbasic ones,
//
//   x_B = c + T x_N,   at first  w = q + M z + 1 z0
//
// The lexicographic rule acts as if q_i were q_i + eps^(i + 1) for a small eps. A row of the inverse basis tells how
// its constant then changes: it stands, with its sign turned, in the columns of nonbasic w (Cottle, Pang & Stone
// 1992, 4.9).
#include <cmath>
#include <vector>

#include "base/cancel.h"
#include "sim/local_problem/lcp/lcp.h"

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

class Dictionary {
 public:
  explicit Dictionary(const Lcp& lcp)
      : n_(lcp.size()), t_(n_, n_ + 2), basic_(n_), nonbasic_(n_ + 1), place_(2 * n_ + 1) {
    t_.leftCols(n_) = Eigen::MatrixXd(lcp.m);
    t_.col(n_).setOnes();
    t_.col(constant()) = lcp.q;
    for (Index i = 0; i < n_; ++i) set_basic(i, i);
    for (Index j = 0; j <= n_; ++j) set_nonbasic(j, n_ + j);
  }

  Index z0() const { return 2 * n_; }
  Index complement(Index variable) const { return variable < n_ ? variable + n_ : variable - n_; }

  /// Row to leave for the first step, in which z0 enters: the lexicographically lowest constant.
  Index lowest_row() const {
    Index lowest = 0;
    for (Index i = 1; i < n_; ++i)
      if (is_before(i, 1, lowest, 1)) lowest = i;
    return lowest;
  }

  /// Row that first reaches 0 as `entering` grows, z0 where it ties; -1: none does.
  Index blocking_row(Index entering) const {
    const Index column = place_[entering];
    const double least = 1e-11 * std::max(1.0, t_.col(column).cwiseAbs().maxCoeff());
    Index best = -1;
    for (Index i = 0; i < n_; ++i)
      if (const double slope = -t_(i, column); slope > least)
        if (best < 0 || is_before(i, slope, best, -t_(best, column))) best = i;
    return best;
  }

  /// `entering` becomes basic in `row`; returns the variable that leaves.
  Index pivot(Index row, Index entering) {
    const Index column = place_[entering], leaving = basic_[row];
    const double pivot = t_(row, column);
    t_.row(row) /= -pivot;
    t_(row, column) = 1 / pivot;
    const Eigen::RowVectorXd source = t_.row(row);
    for (Index i = 0; i < n_; ++i) {
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
    for (Index i = 0; i < n_; ++i)
      if (basic_[i] >= n_ && basic_[i] < 2 * n_) x[basic_[i] - n_] = std::max(0.0, t_(i, constant()));
    return x;
  }
  std::vector<Index> basic_z() const {
    std::vector<Index> found;
    for (const Index v : basic_)
      if (v >= n_ && v < 2 * n_) found.push_back(v - n_);
    return found;
  }
  double least_constant() const { return t_.col(constant()).minCoeff(); }

 private:
  Index constant() const { return n_ + 1; }
  void set_basic(Index row, Index variable) { place_[basic_[row] = variable] = row; }
  void set_nonbasic(Index column, Index variable) { place_[nonbasic_[column] = variable] = column; }
  bool is_basic(Index variable) const { return place_[variable] < n_ && basic_[place_[variable]] == variable; }

  /// Whether (c_a, inverse basis row a) / slope_a is lexicographically below that of b.
  bool is_before(Index a, double slope_a, Index b, double slope_b) const {
    const auto compare = [&](double x, double y) {
      const double difference = x / slope_a - y / slope_b;
      return std::abs(difference) <= 1e-12 * (1 + std::abs(x / slope_a)) ? 0 : difference < 0 ? -1 : 1;
    };
    if (const int order = compare(t_(a, constant()), t_(b, constant())); order != 0) return order < 0;
    if (basic_[a] == z0() || basic_[b] == z0()) return basic_[a] == z0();  // the end, when z0 may leave
    for (Index j = 0; j < n_; ++j) {
      const bool basic = is_basic(j);
      const double x = basic ? double(place_[j] == a) : -t_(a, place_[j]);
      const double y = basic ? double(place_[j] == b) : -t_(b, place_[j]);
      if (const int order = compare(x, y); order != 0) return order < 0;
    }
    return false;
  }

  Index n_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> t_;  // T and, last, c
  std::vector<Index> basic_, nonbasic_, place_;  // variables: w 0 .. n - 1, z n .. 2n - 1, z0; place: row or column
};

/// The solution of the last basis without the rounding of its pivots, where that is better.
void polish(const Lcp& lcp, const std::vector<Index>& basis, LcpSolution& solution) {
  const Index size = Index(basis.size());
  if (size == 0) return;
  Eigen::MatrixXd block(size, size);
  VectorXd rhs(size);
  for (Index a = 0; a < size; ++a) {
    const VectorXd row = lcp.m.row(basis[a]);
    for (Index b = 0; b < size; ++b) block(a, b) = row[basis[b]];
    rhs[a] = -lcp.q[basis[a]];
  }
  const VectorXd found = block.partialPivLu().solve(rhs);
  if (!found.allFinite()) return;
  VectorXd x = VectorXd::Zero(lcp.size());
  for (Index a = 0; a < size; ++a) x[basis[a]] = std::max(0.0, found[a]);
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
    Index entering = dictionary.z0(), row = dictionary.lowest_row();
    while (row >= 0 && solution.iterations < max) {
      stop_if_cancelled();
      const Index leaving = dictionary.pivot(row, entering);
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

}  // namespace gonogo::sim
