// Diagonal blocks of sparse matrices. Inside sim/local_problem.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <vector>

namespace gonogo::sim {

/// The blocks of `size` rows on the diagonal.
inline std::vector<Eigen::MatrixXd> diagonal_blocks(const Eigen::SparseMatrix<double>& a, Eigen::Index size) {
  std::vector<Eigen::MatrixXd> block(std::size_t(a.rows() / size), Eigen::MatrixXd::Zero(size, size));
  for (Eigen::Index k = 0; k < a.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it)
      if (it.row() / size == it.col() / size)
        block[std::size_t(it.col() / size)](it.row() % size, it.col() % size) = it.value();
  return block;
}

inline Eigen::SparseMatrix<double> from_diagonal_blocks(const std::vector<Eigen::MatrixXd>& block) {
  const Eigen::Index size = block.empty() ? 1 : block[0].rows(), rows = Eigen::Index(block.size()) * size;
  std::vector<Eigen::Triplet<double>> entry;
  for (std::size_t k = 0; k < block.size(); ++k)
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j < size; ++j)
        entry.emplace_back(Eigen::Index(k) * size + i, Eigen::Index(k) * size + j, block[k](i, j));
  Eigen::SparseMatrix<double> out(rows, rows);
  out.setFromTriplets(entry.begin(), entry.end());
  return out;
}

/// The inverse of a matrix that has diagonal blocks alone.
inline Eigen::SparseMatrix<double> inverse_blocks(const Eigen::SparseMatrix<double>& a, Eigen::Index size) {
  std::vector<Eigen::MatrixXd> block = diagonal_blocks(a, size);
  for (Eigen::MatrixXd& b : block) b = b.inverse().eval();
  return from_diagonal_blocks(block);
}

}  // namespace gonogo::sim
