#include <cmath>
#include <map>

#include "sim/local_problem/tensor_train/tensor_train.h"

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Blocks of a matrix that are not 0, each a column of coefficients.
struct Blocks {
  std::vector<std::pair<Index, Index>> at;  // block row and column, ascending
  MatrixXd value;                           // [coefficients x blocks]
};

Blocks leaf_blocks(const Eigen::SparseMatrix<double>& a, const Hierarchy& tree) {
  const Index m = tree.leaf_rows;
  std::map<std::pair<Index, Index>, Index> number;
  std::vector<char> filled(std::size_t(tree.size()), 0);
  const auto visit = [&](auto act) {
    for (Index k = 0; k < a.outerSize(); ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it)
        act(tree.place[std::size_t(it.row())], tree.place[std::size_t(it.col())], it.value());
    for (Index k = 0; k < tree.size(); ++k)
      if (!filled[std::size_t(k)]) act(k, k, 1.0);
  };
  for (const Index place : tree.place) filled[std::size_t(place)] = 1;
  visit([&](Index i, Index j, double) { number[{i / m, j / m}] = 0; });
  Blocks out;
  for (auto& [at, k] : number) {
    k = Index(out.at.size());
    out.at.push_back(at);
  }
  out.value = MatrixXd::Zero(m * m, Index(out.at.size()));
  visit([&](Index i, Index j, double value) { out.value((i % m) * m + j % m, number.at({i / m, j / m})) += value; });
  return out;
}

/// Columns that span `m` but for `allowed` in the Frobenius norm, orthonormal.
MatrixXd basis(const MatrixXd& m, double allowed, Index max_rank) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(m * m.transpose());  // ascending
  const VectorXd& square = eigen.eigenvalues();
  double dropped = 0;
  Index first = 0;
  for (; first + 1 < square.size(); ++first) {
    dropped += std::max(square[first], 0.0);
    if (dropped > allowed * allowed) break;
  }
  const Index rank = std::min(square.size() - first, max_rank);
  return eigen.eigenvectors().rightCols(rank).rowwise().reverse();
}

TtCore core_of(const MatrixXd& span, Index digits, Index right) {
  TtCore c(digits, span.cols(), right);
  for (Index k = 0; k < digits * digits; ++k)
    c.value.middleCols(k * right, right) = span.middleRows(k * right, right).transpose();
  return c;
}

/// Four blocks together, as one of the level above.
Blocks joined(const Blocks& fine) {
  const Index rank = fine.value.rows();
  std::map<std::pair<Index, Index>, Index> number;
  for (const auto& [i, j] : fine.at) number[{i / 2, j / 2}] = 0;
  Blocks out;
  for (auto& [at, k] : number) {
    k = Index(out.at.size());
    out.at.push_back(at);
  }
  out.value = MatrixXd::Zero(4 * rank, Index(out.at.size()));
  for (std::size_t k = 0; k < fine.at.size(); ++k) {
    const auto [i, j] = fine.at[k];
    out.value.col(number.at({i / 2, j / 2})).segment(((i % 2) * 2 + j % 2) * rank, rank) = fine.value.col(Index(k));
  }
  return out;
}

}  // namespace

TtMatrix compress(const Eigen::SparseMatrix<double>& a, const Hierarchy& tree, double tolerance, Index max_rank) {
  Blocks blocks = leaf_blocks(a, tree);
  const double allowed = tolerance * blocks.value.norm() / std::sqrt(double(tree.levels + 1));
  TtMatrix out;
  out.core.resize(std::size_t(tree.levels) + 1);
  MatrixXd span = basis(blocks.value, allowed, max_rank);
  out.core.back() = core_of(span, tree.leaf_rows, 1);
  for (int level = tree.levels - 1; level >= 0; --level) {
    const Index right = span.cols();
    blocks.value = span.transpose() * blocks.value;
    blocks = joined(blocks);
    span = level > 0 ? basis(blocks.value, allowed, max_rank) : blocks.value;  // one block is left at the root
    out.core[std::size_t(level)] = core_of(span, 2, right);
  }
  return out;
}

}  // namespace gonogo::sim
