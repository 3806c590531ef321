// A LocalProblem as Eigen sees it, scaled so that all numbers are near 1, and matrices of its blocks.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/local_problem/problem.h"

namespace gonogo::sim {

/// Impulses in units of the root of each contact's inverse mass, velocities in units of the largest free one. A contact
/// has one unit, so that its cone stays itself. The unit diagonal of W is that of the normals.
struct ScaledProblem {
  Eigen::SparseMatrix<double> w;
  Eigen::VectorXd q, unit;
  double speed = 1;

  explicit ScaledProblem(const LocalProblem& p) : w(rows(p), rows(p)), q(rows(p)), unit(rows(p)) {
    const int d = p.dimension;
    for (Index i = 0; i < p.contact_count(); ++i)
      unit.segment(i * d, d).setConstant(1 / std::sqrt(p.diagonal_block(i)[0]));
    q = unit.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(p.q.data(), unit.size()));
    speed = std::max(q.lpNorm<Eigen::Infinity>(), 1e-300);
    q /= speed;
    std::vector<Eigen::Triplet<double>> entry;
    for (Index i = 0; i < p.contact_count(); ++i)
      for (Index k = p.w.first[i]; k < p.w.first[i + 1]; ++k)
        for (int a = 0; a < d * d; ++a) {
          const Index row = i * d + a / d, column = p.w.column[k] * d + a % d;
          entry.emplace_back(row, column, p.w.value[std::size_t(k) * d * d + a] * unit[row] * unit[column]);
        }
    w.setFromTriplets(entry.begin(), entry.end());
  }

  /// In the units of the problem.
  std::vector<double> impulses(const Eigen::VectorXd& r) const {
    const Eigen::VectorXd out = r.cwiseProduct(unit) * speed;
    return {out.begin(), out.end()};
  }

 private:
  static Eigen::Index rows(const LocalProblem& p) { return Eigen::Index(p.q.size()); }
};

/// B of W = B B^T (BodyForm) in the units of `of`, without the rows that stay 0.
inline Eigen::SparseMatrix<double> scaled_form(const LocalProblem& p, const ScaledProblem& of,
                                               const std::vector<char>& fixed) {
  constexpr int kFreedoms = BodyForm::kFreedoms;
  std::vector<Eigen::Triplet<double>> entry;
  for (Index i = 0; i < p.contact_count(); ++i) {
    const BodyForm::Contact& c = p.bodies->contact[std::size_t(i)];
    for (int k = 0; k < 2; ++k)
      for (int a = 0; a < p.dimension && c.body[k] >= 0; ++a) {
        const Index row = i * p.dimension + a;
        for (int f = 0; f < kFreedoms && !fixed[std::size_t(row)]; ++f)
          if (c.row[k][a][f] != 0) entry.emplace_back(row, c.body[k] * kFreedoms + f, of.unit[row] * c.row[k][a][f]);
      }
  }
  Eigen::SparseMatrix<double> b(Eigen::Index(p.q.size()), Eigen::Index(p.bodies->body_count) * kFreedoms);
  b.setFromTriplets(entry.begin(), entry.end());
  return b;
}

/// x of (B B^T + C) x = rhs by `once(rhs)`, then refined against the matrix itself, at most `most` times, while what is
/// left is above `enough` of rhs. False where x is not finite.
template <class Once>
bool solve_refined(const Eigen::SparseMatrix<double>& b, const Eigen::SparseMatrix<double>& transposed,
                   const Eigen::SparseMatrix<double>& cones, const Eigen::VectorXd& rhs, int most, double enough,
                   const Once& once, Eigen::VectorXd& x) {
  x = once(rhs);
  for (int k = 0; k < most; ++k) {
    const Eigen::VectorXd left = rhs - b * Eigen::VectorXd(transposed * x) - cones * x;
    if (!(left.norm() > enough * rhs.norm())) break;
    x += once(left);
  }
  return x.allFinite();
}

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
