// Orders of rows and columns that draw the entries of a sparse matrix to its diagonal.
#pragma once
#include <Eigen/Sparse>
#include <vector>

#include "sim/local_problem/banded/banded_matrix.h"

namespace gonogo::sim {

/// Row of each place, by reverse Cuthill-McKee on the pattern of A + A^T (Boost.Graph). A: square.
std::vector<Eigen::Index> reverse_cuthill_mckee(const Eigen::SparseMatrix<double>& a);

struct Band {
  BandedMatrix<double> matrix;
  Eigen::Index full_half = 0;  // half-bandwidth in this order with nothing dropped
  double dropped = 0;          // share of the Frobenius norm outside of the band that is kept
};

/// P A P^T with entries more than `most_half` from the diagonal dropped.
Band to_band(const Eigen::SparseMatrix<double>& a, const std::vector<Eigen::Index>& order, Eigen::Index most_half);

}  // namespace gonogo::sim
