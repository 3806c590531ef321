#include "sim/local_problem/algebra/tensor_train.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace gonogo::sim {
namespace {

using Graph = std::vector<std::vector<Eigen::Index>>;

Graph neighbours_of(const Eigen::SparseMatrix<double>& a, int block) {
  Graph graph(std::size_t(a.cols() / block));
  for (Eigen::Index k = 0; k < a.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it)
      if (it.row() / block != it.col() / block) graph[std::size_t(it.col() / block)].push_back(it.row() / block);
  for (auto& near : graph) {
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }
  return graph;
}

class Halving {
 public:
  Halving(const Graph& graph, Hierarchy& out, int block)
      : graph_(graph), out_(out), block_(block), part_(graph.size(), -1), seen_(graph.size(), 0) {}

  void split(std::vector<Eigen::Index> nodes, int level, Eigen::Index first_place) {
    if (level == out_.levels) {
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (int a = 0; a < block_; ++a)
          out_.place[std::size_t(nodes[k] * block_ + a)] = first_place + Eigen::Index(k) * block_ + a;
      return;
    }
    ++mark_;
    for (const Eigen::Index node : nodes) part_[std::size_t(node)] = mark_;
    nodes = breadth_first(breadth_first(nodes).back(), nodes);
    const auto middle = nodes.begin() + std::ptrdiff_t((nodes.size() + 1) / 2);
    const Eigen::Index half = out_.leaf_rows << (out_.levels - level - 1);
    const std::vector<Eigen::Index> first(nodes.begin(), middle), second(middle, nodes.end());
    split(first, level + 1, first_place);
    split(second, level + 1, first_place + half);
  }

 private:
  std::vector<Eigen::Index> breadth_first(const std::vector<Eigen::Index>& nodes) {
    return nodes.empty() ? std::vector<Eigen::Index>{0} : breadth_first(nodes.front(), nodes);
  }

  /// All `nodes` of the part, component by component, from `start`.
  std::vector<Eigen::Index> breadth_first(Eigen::Index start, const std::vector<Eigen::Index>& nodes) {
    std::vector<Eigen::Index> order;
    if (nodes.empty()) return order;
    ++visit_;
    const auto take = [&](Eigen::Index node) {
      if (part_[std::size_t(node)] != mark_ || seen_[std::size_t(node)] == visit_) return;
      seen_[std::size_t(node)] = visit_;
      order.push_back(node);
    };
    take(start);
    std::size_t next = 0;
    for (std::size_t k = 0; k <= nodes.size(); ++k) {
      for (; next < order.size(); ++next)
        for (const Eigen::Index near : graph_[std::size_t(order[next])]) take(near);
      if (k < nodes.size()) take(nodes[k]);
    }
    return order;
  }

  const Graph& graph_;
  Hierarchy& out_;
  int block_;
  std::vector<long> part_, seen_;
  long mark_ = 0, visit_ = 0;
};

}  // namespace

Hierarchy make_hierarchy(const Eigen::SparseMatrix<double>& pattern, int block, int leaf_nodes) {
  const Graph graph = neighbours_of(pattern, block);
  const Eigen::Index count = Eigen::Index(graph.size());
  Hierarchy out;
  out.levels = 1;
  while (((count - 1) >> out.levels) + 1 > leaf_nodes) ++out.levels;
  out.leaf_rows = (((count - 1) >> out.levels) + 1) * block;
  out.place.resize(std::size_t(pattern.rows()));
  std::vector<Eigen::Index> nodes(graph.size());
  for (Eigen::Index k = 0; k < count; ++k) nodes[std::size_t(k)] = k;
  Halving(graph, out, block).split(std::move(nodes), 0, 0);
  return out;
}

using Eigen::MatrixXd;
using Eigen::VectorXd;

Eigen::Index TtMatrix::size() const {
  Eigen::Index rows = 1;
  for (const TtCore& c : core) rows *= c.digits;
  return rows;
}

Eigen::Index TtMatrix::rank() const {
  Eigen::Index rank = 1;
  for (const TtCore& c : core) rank = std::max(rank, c.right);
  return rank;
}

std::size_t TtMatrix::bytes() const {
  std::size_t count = 0;
  for (const TtCore& c : core) count += std::size_t(c.value.size());
  return count * sizeof(double);
}

VectorXd TtMatrix::apply(const VectorXd& x) const {
  MatrixXd t = x.transpose();  // [rank x places]; the latter: columns still to sum, then rows already there
  Eigen::Index rows = 1, columns = size();
  for (auto c = core.rbegin(); c != core.rend(); ++c) {
    const Eigen::Index n = c->digits, blocks = columns / n;
    MatrixXd next = MatrixXd::Zero(c->left, t.cols());
    for (Eigen::Index block = 0; block < blocks; ++block)
      for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
          next.middleCols((block * n + i) * rows, rows).noalias() +=
              c->slice(i, j) * t.middleCols((block * n + j) * rows, rows);
    t = std::move(next);
    rows *= n;
    columns = blocks;
  }
  return t.transpose();
}

MatrixXd TtMatrix::dense() const {
  const Eigen::Index n = size();
  MatrixXd out(n, n);
  for (Eigen::Index j = 0; j < n; ++j) out.col(j) = apply(VectorXd::Unit(n, j));
  return out;
}

TtMatrix TtMatrix::transposed() const {
  TtMatrix out = *this;
  for (std::size_t k = 0; k < core.size(); ++k)
    for (Eigen::Index i = 0; i < core[k].digits; ++i)
      for (Eigen::Index j = 0; j < core[k].digits; ++j) out.core[k].slice(i, j) = core[k].slice(j, i);
  return out;
}

TtMatrix TtMatrix::identity(const Hierarchy& tree) {
  TtMatrix out;
  for (int k = 0; k <= tree.levels; ++k) {
    TtCore c(k < tree.levels ? 2 : tree.leaf_rows, 1, 1);
    for (Eigen::Index i = 0; i < c.digits; ++i) c.slice(i, i)(0, 0) = 1;
    out.core.push_back(c);
  }
  return out;
}

namespace {

/// Blocks of a matrix that are not 0, each a column of coefficients.
struct Blocks {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> at;  // block row and column, ascending
  MatrixXd value;                                         // [coefficients x blocks]
};

Blocks leaf_blocks(const Eigen::SparseMatrix<double>& a, const Hierarchy& tree) {
  const Eigen::Index m = tree.leaf_rows;
  std::map<std::pair<Eigen::Index, Eigen::Index>, Eigen::Index> number;
  std::vector<char> filled(std::size_t(tree.size()), 0);
  const auto visit = [&](auto act) {
    for (Eigen::Index k = 0; k < a.outerSize(); ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it)
        act(tree.place[std::size_t(it.row())], tree.place[std::size_t(it.col())], it.value());
    for (Eigen::Index k = 0; k < tree.size(); ++k)
      if (!filled[std::size_t(k)]) act(k, k, 1.0);
  };
  for (const Eigen::Index place : tree.place) filled[std::size_t(place)] = 1;
  visit([&](Eigen::Index i, Eigen::Index j, double) { number[{i / m, j / m}] = 0; });
  Blocks out;
  for (auto& [at, k] : number) {
    k = Eigen::Index(out.at.size());
    out.at.push_back(at);
  }
  out.value = MatrixXd::Zero(m * m, Eigen::Index(out.at.size()));
  visit([&](Eigen::Index i, Eigen::Index j, double value) {
    out.value((i % m) * m + j % m, number.at({i / m, j / m})) += value;
  });
  return out;
}

/// Columns that span `m` but for `allowed` in the Frobenius norm, orthonormal.
MatrixXd basis(const MatrixXd& m, double allowed, Eigen::Index max_rank) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(m * m.transpose());  // ascending
  const VectorXd& square = eigen.eigenvalues();
  double dropped = 0;
  Eigen::Index first = 0;
  for (; first + 1 < square.size(); ++first) {
    dropped += std::max(square[first], 0.0);
    if (dropped > allowed * allowed) break;
  }
  const Eigen::Index rank = std::min(square.size() - first, max_rank);
  return eigen.eigenvectors().rightCols(rank).rowwise().reverse();
}

TtCore core_of(const MatrixXd& span, Eigen::Index digits, Eigen::Index right) {
  TtCore c(digits, span.cols(), right);
  for (Eigen::Index k = 0; k < digits * digits; ++k)
    c.value.middleCols(k * right, right) = span.middleRows(k * right, right).transpose();
  return c;
}

/// Four blocks together, as one of the level above.
Blocks joined(const Blocks& fine) {
  const Eigen::Index rank = fine.value.rows();
  std::map<std::pair<Eigen::Index, Eigen::Index>, Eigen::Index> number;
  for (const auto& [i, j] : fine.at) number[{i / 2, j / 2}] = 0;
  Blocks out;
  for (auto& [at, k] : number) {
    k = Eigen::Index(out.at.size());
    out.at.push_back(at);
  }
  out.value = MatrixXd::Zero(4 * rank, Eigen::Index(out.at.size()));
  for (std::size_t k = 0; k < fine.at.size(); ++k) {
    const auto [i, j] = fine.at[k];
    out.value.col(number.at({i / 2, j / 2})).segment(((i % 2) * 2 + j % 2) * rank, rank) =
        fine.value.col(Eigen::Index(k));
  }
  return out;
}

}  // namespace

TtMatrix compress(const Eigen::SparseMatrix<double>& a, const Hierarchy& tree, double tolerance,
                  Eigen::Index max_rank) {
  Blocks blocks = leaf_blocks(a, tree);
  const double allowed = tolerance * blocks.value.norm() / std::sqrt(double(tree.levels + 1));
  TtMatrix out;
  out.core.resize(std::size_t(tree.levels) + 1);
  MatrixXd span = basis(blocks.value, allowed, max_rank);
  out.core.back() = core_of(span, tree.leaf_rows, 1);
  for (int level = tree.levels - 1; level >= 0; --level) {
    const Eigen::Index right = span.cols();
    blocks.value = span.transpose() * blocks.value;
    blocks = joined(blocks);
    span = level > 0 ? basis(blocks.value, allowed, max_rank) : blocks.value;  // one block is left at the root
    out.core[std::size_t(level)] = core_of(span, 2, right);
  }
  return out;
}

namespace {

using Terms = std::vector<MatrixXd>;  // one matrix per rank of A

/// What the cores on one side of a pair add up to: X^T A X for each rank of A, and tr X.
struct Side {
  Terms form;      // [rank of A], each [rank of X x rank of X]
  VectorXd trace;  // [rank of X]
};

Side unit_side() { return {{MatrixXd::Ones(1, 1)}, VectorXd::Ones(1)}; }

/// sum_b A(b, a; i, j) form[b], for each a.
Terms weighted(const Terms& form, const TtCore& a, Eigen::Index i, Eigen::Index j, bool from_left) {
  const auto slice = a.slice(i, j);
  const Eigen::Index count = from_left ? a.right : a.left;
  Terms out(std::size_t(count), MatrixXd::Zero(form[0].rows(), form[0].cols()));
  for (Eigen::Index k = 0; k < count; ++k)
    for (std::size_t b = 0; b < form.size(); ++b)
      if (const double w = from_left ? slice(Eigen::Index(b), k) : slice(k, Eigen::Index(b)); w != 0)
        out[std::size_t(k)] += w * form[b];
  return out;
}

Side passed_right(const Side& side, const TtCore& a, const TtCore& x) {
  Side out{Terms(std::size_t(a.right), MatrixXd::Zero(x.right, x.right)), VectorXd::Zero(x.right)};
  for (Eigen::Index i = 0; i < x.digits; ++i) {
    out.trace += x.slice(i, i).transpose() * side.trace;
    for (Eigen::Index j = 0; j < x.digits; ++j) {
      const Terms w = weighted(side.form, a, i, j, true);
      for (std::size_t k = 0; k < w.size(); ++k)
        for (Eigen::Index l = 0; l < x.digits; ++l)
          out.form[k].noalias() += x.slice(i, l).transpose() * w[k] * x.slice(j, l);
    }
  }
  return out;
}

Side passed_left(const Side& side, const TtCore& a, const TtCore& x) {
  Side out{Terms(std::size_t(a.left), MatrixXd::Zero(x.left, x.left)), VectorXd::Zero(x.left)};
  for (Eigen::Index i = 0; i < x.digits; ++i) {
    out.trace += x.slice(i, i) * side.trace;
    for (Eigen::Index j = 0; j < x.digits; ++j) {
      const Terms w = weighted(side.form, a, i, j, false);
      for (std::size_t k = 0; k < w.size(); ++k)
        for (Eigen::Index l = 0; l < x.digits; ++l)
          out.form[k].noalias() += x.slice(i, l) * w[k] * x.slice(j, l).transpose();
    }
  }
  return out;
}

/// Products of one core with its side, for each rank between the pair: rows and columns (rank of X, digit) on the left,
/// (digit, rank of X) on the right.
Terms operators(const Side& side, const TtCore& a, bool is_left) {
  const Eigen::Index n = a.digits, s = side.trace.size(), count = is_left ? a.right : a.left;
  Terms out(std::size_t(count), MatrixXd::Zero(n * s, n * s));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const Terms w = weighted(side.form, a, i, j, is_left);
      for (std::size_t k = 0; k < w.size(); ++k)
        for (Eigen::Index p = 0; p < s; ++p)
          for (Eigen::Index q = 0; q < s; ++q)
            is_left ? out[k](p * n + i, q * n + j) = w[k](p, q) : out[k](i * s + p, j * s + q) = w[k](p, q);
    }
  return out;
}

/// The same for the identity: [(rank of X, digit) x digit].
MatrixXd target(const Side& side, Eigen::Index n, bool is_left) {
  const Eigen::Index s = side.trace.size();
  MatrixXd out = MatrixXd::Zero(n * s, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index p = 0; p < s; ++p) out(is_left ? p * n + i : i * s + p, i) = side.trace[p];
  return out;
}

void add_kronecker(const MatrixXd& a, const MatrixXd& b, MatrixXd& out) {
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j)
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
      const Eigen::Index rank = std::min(c.left, c.value.cols());
      const Eigen::HouseholderQR<MatrixXd> qr(c.value.transpose());
      const MatrixXd q = qr.householderQ() * MatrixXd::Identity(c.value.cols(), rank);
      const MatrixXd r = q.transpose() * c.value.transpose();  // [rank x left]
      TtCore shorter(c.digits, rank, c.right), carried(before.digits, before.left, rank);
      shorter.value = q.transpose();
      for (Eigen::Index i = 0; i < before.digits; ++i)
        for (Eigen::Index j = 0; j < before.digits; ++j) carried.slice(i, j) = before.slice(i, j) * r.transpose();
      c = shorter;
      before = carried;
    }
  }

  void solve_pair(std::size_t k, bool to_the_right) {
    const Side &left = left_[k], &right = right_[k + 1];
    const Eigen::Index n = a_.core[k].digits, m = a_.core[k + 1].digits, s = left.trace.size(), t = right.trace.size();
    const Terms of_left = operators(left, a_.core[k], true), of_right = operators(right, a_.core[k + 1], false);
    MatrixXd local = MatrixXd::Zero(s * n * m * t, s * n * m * t), rhs = MatrixXd::Zero(s * n * m * t, n * m);
    for (std::size_t c = 0; c < of_left.size(); ++c) add_kronecker(of_left[c], of_right[c], local);
    add_kronecker(target(left, n, true), target(right, m, false), rhs);
    const MatrixXd v = local.llt().solve(rhs);  // [(p j1)(j2 q) x (l1 l2)]
    if (!v.allFinite()) return;                 // the truncated A is not definite here: the pair stays
    MatrixXd pair(s * n * n, m * m * t);
    for (Eigen::Index p = 0; p < s; ++p)
      for (Eigen::Index j1 = 0; j1 < n; ++j1)
        for (Eigen::Index l1 = 0; l1 < n; ++l1)
          for (Eigen::Index j2 = 0; j2 < m; ++j2)
            for (Eigen::Index l2 = 0; l2 < m; ++l2)
              for (Eigen::Index q = 0; q < t; ++q)
                pair((p * n + j1) * n + l1, (j2 * m + l2) * t + q) = v((p * n + j1) * m * t + j2 * t + q, l1 * m + l2);
    split(pair, k, s, n, m, t, to_the_right);
  }

  void split(const MatrixXd& pair, std::size_t k, Eigen::Index s, Eigen::Index n, Eigen::Index m, Eigen::Index t,
             bool to_the_right) {
    const Eigen::BDCSVD<MatrixXd> svd(pair, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const VectorXd& value = svd.singularValues();
    Eigen::Index rank = value.size();
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
    for (Eigen::Index p = 0; p < s; ++p)
      for (Eigen::Index d = 0; d < n * n; ++d) first.value.block(p, d * rank, 1, rank) = u.row(p * n * n + d);
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
  for (Eigen::Index k = 0; k < v.size(); ++k) v[k] = std::sin(1.7 * double(k + 1)) < 0 ? -1 : 1;
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
