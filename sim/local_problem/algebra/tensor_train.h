// Sparse matrices and their inverses as tensor trains.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cstddef>
#include <vector>

namespace gonogo::sim {

// An order of the contacts in which neighbours are near each other at every scale: a binary tree of halves.

/// Rows in blocks of `block` are the nodes of a graph. It is halved again and again until a leaf holds at most
/// `leaf_nodes`. Each half is one side of a breadth-first order from a node at the rim.
struct Hierarchy {
  int levels = 0;                   // of halving, at least 1
  Eigen::Index leaf_rows = 0;       // of a leaf, filled up
  std::vector<Eigen::Index> place;  // [row] place in the tree's order, which has 2^levels leaf_rows places

  Eigen::Index size() const { return leaf_rows << levels; }
};

Hierarchy make_hierarchy(const Eigen::SparseMatrix<double>& pattern, int block, int leaf_nodes);

// A square matrix as a tensor train (Oseledets 2011): rows and columns are counted by the digits of their place in a
// tree, from the root to the leaves.
//
//   A(i, j) = G_0(i_0, j_0) G_1(i_1, j_1) ... G_L(i_L, j_L),  G_k(i, j): matrix of r_k x r_{k+1}, r_0 = r_{L+1} = 1
//
// The digits of levels 0 .. L - 1 are 0 or 1, the last one counts the rows of a leaf. Where blocks far from each other
// look alike, the ranks r_k stay small.

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

// The inverse of a symmetric positive definite tensor train as a tensor train, by alternating minimisation of
// tr(X^T A X) / 2 - tr X over two neighbouring cores at a time (density matrix renormalisation; Oseledets & Dolgov
// 2012, section 4, as used by Corona, Rahimian & Zorin 2017).

struct TtInverseSettings {
  double tolerance = 1e-3;     // of each split of two cores, relative to them
  Eigen::Index max_rank = 12;  // local systems have up to 4 max_rank^2 unknowns
  int max_sweeps = 4;          // to the leaves and back
};

struct TtInverse {
  TtMatrix x;
  double residual = 0;  // |A X v - v| / |v| for a fixed v of ones with changing signs
  int sweeps = 0;
};

/// `start`: an inverse of a matrix nearby, or the identity. Ends where the residual is below the tolerance or no longer
/// halves.
TtInverse invert(const TtMatrix& a, const TtMatrix& start, const TtInverseSettings& settings);

}  // namespace gonogo::sim
