// A LocalProblem as Eigen sees it, scaled so that all numbers are near 1. Inside sim/local_problem.
#pragma once
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>

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

}  // namespace gonogo::sim
