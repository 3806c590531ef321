// A square matrix as a tensor train (Oseledets 2011): rows and columns are counted by the digits of their place in a
// tree, from the root to the leaves.
//
//   A(i, j) = G_0(i_0, j_0) G_1(i_1, j_1) ... G_L(i_L, j_L),  G_k(i, j): matrix of r_k x r_{k+1}, r_0 = r_{L+1} = 1
//
// The digits of levels 0 .. L - 1 are 0 or 1, the last one counts the rows of a leaf. Where blocks far from each other
// look alike, the ranks r_k stay small.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cstddef>
#include <vector>

#include "sim/local_problem/tensor_train/hierarchy.h"

namespace gonogo::sim {

struct TtCore {
  Eigen::Index digits = 2, left = 1, right = 1;
  Eigen::MatrixXd value;  // [left x digits digits right], G(i, j) at columns (i digits + j) right ..

  TtCore() = default;
  TtCore(Eigen::Index n, Eigen::Index l, Eigen::Index r)
      : digits(n), left(l), right(r), value(Eigen::MatrixXd::Zero(l, n * n * r)) {}

  auto slice(Eigen::Index i, Eigen::Index j) { return value.middleCols((i * digits + j) * right, right); }
  auto slice(Eigen::Index i, Eigen::Index j) const { return value.middleCols((i * digits + j) * right, right); }
};

struct TtMatrix {
  std::vector<TtCore> core;  // [levels + 1], the leaf last

  Eigen::Index size() const;  // rows
  Eigen::Index rank() const;  // the largest
  std::size_t bytes() const;
  Eigen::VectorXd apply(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd dense() const;
  TtMatrix transposed() const;

  static TtMatrix identity(const Hierarchy& tree);
};

/// P A P^T in the tree's order, with 1 on the diagonal of places that the tree fills up. |A - result| <= tolerance |A|
/// (Frobenius) as long as no rank exceeds `max_rank`; where one would, the largest singular values are kept. tolerance:
/// 1e-7 or more, since singular values come from squares.
TtMatrix compress(const Eigen::SparseMatrix<double>& a, const Hierarchy& tree, double tolerance, Eigen::Index max_rank);

}  // namespace gonogo::sim
