// An order of the contacts in which neighbours are near each other at every scale: a binary tree of halves.
#pragma once
#include <Eigen/Sparse>
#include <vector>

namespace gonogo::sim {

/// Rows in blocks of `block` are the nodes of a graph. It is halved again and again until a leaf holds at most
/// `leaf_nodes`. Each half is one side of a breadth-first order from a node at the rim.
struct Hierarchy {
  int levels = 0;                   // of halving, at least 1
  Eigen::Index leaf_rows = 0;       // of a leaf, filled up
  std::vector<Eigen::Index> place;  // [row] place in the tree's order, which has 2^levels leaf_rows places

  Eigen::Index size() const { return leaf_rows << levels; }
};

Hierarchy make_hierarchy(const Eigen::SparseMatrix<double>& pattern, int block, int leaf_nodes);

}  // namespace gonogo::sim
