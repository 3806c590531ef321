// Where the factors of a symmetric sparse matrix fill, and which of their columns are alike. Inside sim/local_problem.
#pragma once
#include <Eigen/Sparse>
#include <vector>

namespace gonogo::sim {

/// Columns first .. first + width - 1 of L with the rows below them that all of them take as full.
struct ColumnGroup {
  Eigen::Index first = 0, width = 0;
  std::vector<Eigen::Index> row{};  // ascending
  Eigen::Index filled = 0;          // entries of L that merging took as full and that are 0
};

struct FactorPattern {
  std::vector<Eigen::Index> order;  // row of the matrix in each place, by minimum degree (AMD), then by the tree
  std::vector<ColumnGroup> group;   // in the order of columns; a group's first row lies in the group above it
};

/// Of a square matrix with a symmetric pattern and a full diagonal. Groups merge where that adds few zeros.
FactorPattern factor_pattern(const Eigen::SparseMatrix<double>& a);

}  // namespace gonogo::sim
