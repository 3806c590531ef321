// Largest eigenvalue by power iteration, for critical steps. Internal: Eigen.
#pragma once
#include <Eigen/Sparse>
#include <cmath>

namespace gonogo::sim::elastic {

/// Of M^-1 A with lumped mass [dof]; A symmetric, at least positive semidefinite.
inline double largest_eigenvalue(const Eigen::SparseMatrix<double>& a, const Eigen::VectorXd& mass) {
  Eigen::VectorXd x(mass.size());
  for (long i = 0; i < x.size(); ++i) x[i] = std::sin(1 + 12.9898 * double(i));  // no mode is orthogonal to it
  double value = 0;
  for (int k = 0; k < 5000; ++k) {
    x /= std::sqrt(x.dot(mass.cwiseProduct(x)));
    const Eigen::VectorXd y = (a * x).cwiseQuotient(mass);
    const double next = x.dot(mass.cwiseProduct(y));
    const bool settled = std::fabs(next - value) <= 1e-9 * next;
    value = next;
    if (!(value > 0) || (settled && k > 20)) break;
    x = y;
  }
  return value;
}

}  // namespace gonogo::sim::elastic
