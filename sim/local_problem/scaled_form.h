// B of W = B B^T (body_form.h) as Eigen sees it. Inside sim/local_problem.
#pragma once
#include <Eigen/Sparse>
#include <vector>

#include "sim/local_problem/body_form.h"
#include "sim/local_problem/scaled_problem.h"

namespace gonogo::sim {

/// B in the units of `of`, without the rows that stay 0.
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

}  // namespace gonogo::sim
