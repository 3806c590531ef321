#include "sim/local_problem/tensor_train/tt_inverse.h"

#include <algorithm>
#include <cmath>

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Terms = std::vector<MatrixXd>;  // one matrix per rank of A

/// What the cores on one side of a pair add up to: X^T A X for each rank of A, and tr X.
struct Side {
  Terms form;      // [rank of A], each [rank of X x rank of X]
  VectorXd trace;  // [rank of X]
};

Side unit_side() { return {{MatrixXd::Ones(1, 1)}, VectorXd::Ones(1)}; }

/// sum_b A(b, a; i, j) form[b], for each a.
Terms weighted(const Terms& form, const TtCore& a, Index i, Index j, bool from_left) {
  const auto slice = a.slice(i, j);
  const Index count = from_left ? a.right : a.left;
  Terms out(std::size_t(count), MatrixXd::Zero(form[0].rows(), form[0].cols()));
  for (Index k = 0; k < count; ++k)
    for (std::size_t b = 0; b < form.size(); ++b)
      if (const double w = from_left ? slice(Index(b), k) : slice(k, Index(b)); w != 0)
        out[std::size_t(k)] += w * form[b];
  return out;
}

Side passed_right(const Side& side, const TtCore& a, const TtCore& x) {
  Side out{Terms(std::size_t(a.right), MatrixXd::Zero(x.right, x.right)), VectorXd::Zero(x.right)};
  for (Index i = 0; i < x.digits; ++i) {
    out.trace += x.slice(i, i).transpose() * side.trace;
    for (Index j = 0; j < x.digits; ++j) {
      const Terms w = weighted(side.form, a, i, j, true);
      for (std::size_t k = 0; k < w.size(); ++k)
        for (Index l = 0; l < x.digits; ++l) out.form[k].noalias() += x.slice(i, l).transpose() * w[k] * x.slice(j, l);
    }
  }
  return out;
}

Side passed_left(const Side& side, const TtCore& a, const TtCore& x) {
  Side out{Terms(std::size_t(a.left), MatrixXd::Zero(x.left, x.left)), VectorXd::Zero(x.left)};
  for (Index i = 0; i < x.digits; ++i) {
    out.trace += x.slice(i, i) * side.trace;
    for (Index j = 0; j < x.digits; ++j) {
      const Terms w = weighted(side.form, a, i, j, false);
      for (std::size_t k = 0; k < w.size(); ++k)
        for (Index l = 0; l < x.digits; ++l) out.form[k].noalias() += x.slice(i, l) * w[k] * x.slice(j, l).transpose();
    }
  }
  return out;
}

/// Of one core with its side, for each rank between the pair: rows and columns (rank of X, digit) on the left, (digit,
/// rank of X) on the right.
Terms operators(const Side& side, const TtCore& a, bool is_left) {
  const Index n = a.digits, s = side.trace.size(), count = is_left ? a.right : a.left;
  Terms out(std::size_t(count), MatrixXd::Zero(n * s, n * s));
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Terms w = weighted(side.form, a, i, j, is_left);
      for (std::size_t k = 0; k < w.size(); ++k)
        for (Index p = 0; p < s; ++p)
          for (Index q = 0; q < s; ++q)
            is_left ? out[k](p * n + i, q * n + j) = w[k](p, q) : out[k](i * s + p, j * s + q) = w[k](p, q);
    }
  return out;
}

/// Of the identity: [(rank of X, digit) x digit].
MatrixXd target(const Side& side, Index n, bool is_left) {
  const Index s = side.trace.size();
  MatrixXd out = MatrixXd::Zero(n * s, n);
  for (Index i = 0; i < n; ++i)
    for (Index p = 0; p < s; ++p) out(is_left ? p * n + i : i * s + p, i) = side.trace[p];
  return out;
}

void add_kronecker(const MatrixXd& a, const MatrixXd& b, MatrixXd& out) {
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < a.cols(); ++j)
      if (a(i, j) != 0) out.block(i * b.rows(), j * b.cols(), b.rows(), b.cols()) += a(i, j) * b;
}

class Sweeps {
 public:
  Sweeps(const TtMatrix& a, TtMatrix x, const TtInverseSettings& settings)
      : a_(a), x_(std::move(x)), settings_(settings), left_(a.core.size()), right_(a.core.size()) {
    left_[0] = right_.back() = unit_side();
    orthogonalise();
    for (std::size_t k = a_.core.size() - 1; k > 0; --k) right_[k - 1] = passed_left(right_[k], a_.core[k], x_.core[k]);
  }

  void sweep() {
    const std::size_t last = a_.core.size() - 1;
    for (std::size_t k = 0; k < last; ++k) {
      solve_pair(k, true);
      left_[k + 1] = passed_right(left_[k], a_.core[k], x_.core[k]);
    }
    for (std::size_t k = last; k-- > 0;) {
      solve_pair(k, false);
      right_[k] = passed_left(right_[k + 1], a_.core[k + 1], x_.core[k + 1]);
    }
  }
  const TtMatrix& x() const { return x_; }

 private:
  /// Rows of all cores but the first become orthonormal, as the frames of the local systems have to be.
  void orthogonalise() {
    for (std::size_t k = x_.core.size() - 1; k > 0; --k) {
      TtCore &c = x_.core[k], &before = x_.core[k - 1];
      const Index rank = std::min(c.left, c.value.cols());
      const Eigen::HouseholderQR<MatrixXd> qr(c.value.transpose());
      const MatrixXd q = qr.householderQ() * MatrixXd::Identity(c.value.cols(), rank);
      const MatrixXd r = q.transpose() * c.value.transpose();  // [rank x left]
      TtCore shorter(c.digits, rank, c.right), carried(before.digits, before.left, rank);
      shorter.value = q.transpose();
      for (Index i = 0; i < before.digits; ++i)
        for (Index j = 0; j < before.digits; ++j) carried.slice(i, j) = before.slice(i, j) * r.transpose();
      c = shorter;
      before = carried;
    }
  }

  void solve_pair(std::size_t k, bool to_the_right) {
    const Side &left = left_[k], &right = right_[k + 1];
    const Index n = a_.core[k].digits, m = a_.core[k + 1].digits, s = left.trace.size(), t = right.trace.size();
    const Terms of_left = operators(left, a_.core[k], true), of_right = operators(right, a_.core[k + 1], false);
    MatrixXd local = MatrixXd::Zero(s * n * m * t, s * n * m * t), rhs = MatrixXd::Zero(s * n * m * t, n * m);
    for (std::size_t c = 0; c < of_left.size(); ++c) add_kronecker(of_left[c], of_right[c], local);
    add_kronecker(target(left, n, true), target(right, m, false), rhs);
    const MatrixXd v = local.llt().solve(rhs);  // [(p j1)(j2 q) x (l1 l2)]
    if (!v.allFinite()) return;                 // the truncated A is not definite here: the pair stays
    MatrixXd pair(s * n * n, m * m * t);
    for (Index p = 0; p < s; ++p)
      for (Index j1 = 0; j1 < n; ++j1)
        for (Index l1 = 0; l1 < n; ++l1)
          for (Index j2 = 0; j2 < m; ++j2)
            for (Index l2 = 0; l2 < m; ++l2)
              for (Index q = 0; q < t; ++q)
                pair((p * n + j1) * n + l1, (j2 * m + l2) * t + q) = v((p * n + j1) * m * t + j2 * t + q, l1 * m + l2);
    split(pair, k, s, n, m, t, to_the_right);
  }

  void split(const MatrixXd& pair, std::size_t k, Index s, Index n, Index m, Index t, bool to_the_right) {
    const Eigen::BDCSVD<MatrixXd> svd(pair, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const VectorXd& value = svd.singularValues();
    Index rank = value.size();
    double dropped = 0;
    while (rank > 1) {
      dropped = std::hypot(dropped, value[rank - 1]);
      if (dropped > settings_.tolerance * value.norm()) break;
      --rank;
    }
    rank = std::min(rank, settings_.max_rank);
    MatrixXd u = svd.matrixU().leftCols(rank), w = svd.matrixV().leftCols(rank).transpose();
    to_the_right ? w = value.head(rank).asDiagonal()* w : u = u * value.head(rank).asDiagonal();
    TtCore first(n, s, rank), second(m, rank, t);
    for (Index p = 0; p < s; ++p)
      for (Index d = 0; d < n * n; ++d) first.value.block(p, d * rank, 1, rank) = u.row(p * n * n + d);
    second.value = w;
    x_.core[k] = first;
    x_.core[k + 1] = second;
  }

  const TtMatrix& a_;
  TtMatrix x_;
  TtInverseSettings settings_;
  std::vector<Side> left_, right_;  // of cores before k; of cores after k
};

double probe_residual(const TtMatrix& a, const TtMatrix& x) {
  VectorXd v(a.size());
  for (Index k = 0; k < v.size(); ++k) v[k] = std::sin(1.7 * double(k + 1)) < 0 ? -1 : 1;
  return (a.apply(x.apply(v)) - v).norm() / v.norm();
}

}  // namespace

TtInverse invert(const TtMatrix& a, const TtMatrix& start, const TtInverseSettings& settings) {
  Sweeps sweeps(a, start, settings);
  TtInverse best{start, probe_residual(a, start), 0};
  for (int k = 1; k <= settings.max_sweeps && best.residual > settings.tolerance; ++k) {
    sweeps.sweep();
    const double residual = probe_residual(a, sweeps.x());
    const bool stalls = residual > best.residual / 2;
    if (residual < best.residual) best = {sweeps.x(), residual, k};
    if (stalls && k > 1) break;
  }
  return best;
}

}  // namespace gonogo::sim
