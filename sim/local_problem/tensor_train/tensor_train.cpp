#include "sim/local_problem/tensor_train/tensor_train.h"

#include <algorithm>

namespace gonogo::sim {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Index TtMatrix::size() const {
  Index rows = 1;
  for (const TtCore& c : core) rows *= c.digits;
  return rows;
}

Index TtMatrix::rank() const {
  Index rank = 1;
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
  Index rows = 1, columns = size();
  for (auto c = core.rbegin(); c != core.rend(); ++c) {
    const Index n = c->digits, blocks = columns / n;
    MatrixXd next = MatrixXd::Zero(c->left, t.cols());
    for (Index block = 0; block < blocks; ++block)
      for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j)
          next.middleCols((block * n + i) * rows, rows).noalias() +=
              c->slice(i, j) * t.middleCols((block * n + j) * rows, rows);
    t = std::move(next);
    rows *= n;
    columns = blocks;
  }
  return t.transpose();
}

MatrixXd TtMatrix::dense() const {
  const Index n = size();
  MatrixXd out(n, n);
  for (Index j = 0; j < n; ++j) out.col(j) = apply(VectorXd::Unit(n, j));
  return out;
}

TtMatrix TtMatrix::transposed() const {
  TtMatrix out = *this;
  for (std::size_t k = 0; k < core.size(); ++k)
    for (Index i = 0; i < core[k].digits; ++i)
      for (Index j = 0; j < core[k].digits; ++j) out.core[k].slice(i, j) = core[k].slice(j, i);
  return out;
}

TtMatrix TtMatrix::identity(const Hierarchy& tree) {
  TtMatrix out;
  for (int k = 0; k <= tree.levels; ++k) {
    TtCore c(k < tree.levels ? 2 : tree.leaf_rows, 1, 1);
    for (Index i = 0; i < c.digits; ++i) c.slice(i, i)(0, 0) = 1;
    out.core.push_back(c);
  }
  return out;
}

}  // namespace gonogo::sim
