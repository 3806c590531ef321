// phi(a, b) = sqrt(a^2 + b^2) - a - b is 0 exactly where 0 <= a, 0 <= b, a b = 0. Newton's method finds the zero of
// phi(x, M x + q) row by row; the merit 1/2 |phi|^2 is smooth, so that gradients help where Newton's direction fails.
#include <Eigen/SparseLU>
#include <cmath>

#include "base/cancel.h"
#include "sim/local_problem/lcp/lcp.h"

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

class FischerBurmeister {
 public:
  explicit FischerBurmeister(const Lcp& lcp) : lcp_(lcp), x_(VectorXd::Zero(lcp.size())) { evaluate(x_); }

  VectorXd point() const { return x_.cwiseMax(0.0); }
  double merit() const { return 0.5 * phi_.squaredNorm(); }

  /// One step; false when no step lowers the merit.
  bool step() {
    const Sparse h = jacobian();
    const VectorXd gradient = h.transpose() * phi_;
    if (!(gradient.norm() > 0)) return false;
    lu_.compute(h);
    if (lu_.info() == Eigen::Success) {
      const VectorXd d = lu_.solve(-phi_);
      const double least = 1e-8 * std::pow(d.norm(), 2.1);
      if (d.allFinite() && gradient.dot(d) <= -least && search(d, gradient.dot(d))) return true;
    }
    return search(-gradient, -gradient.squaredNorm());
  }

 private:
  void evaluate(const VectorXd& x) {
    w_ = lcp_.m * x + lcp_.q;
    phi_.resize(x.size());
    for (Index i = 0; i < x.size(); ++i) phi_[i] = value(x[i], w_[i]);
  }

  /// sqrt(a^2 + b^2) - a - b without cancellation.
  static double value(double a, double b) {
    const double sum = a + b, root = std::hypot(a, b);
    return sum > 0 ? -2 * a * b / (root + sum) : root - sum;
  }

  /// An element of the generalised Jacobian, diag(da) + diag(db) (M + epsilon), where a and b are 0 by the limit along
  /// the ones vector (De Luca et al., 7.1). epsilon falls with the merit and keeps it regular for M of class P0
  /// (Facchinei & Kanzow 1999).
  Sparse jacobian() const {
    const double epsilon = 1e-3 * std::min(1.0, phi_.lpNorm<Eigen::Infinity>());
    VectorXd ones = VectorXd::Zero(x_.size());
    for (Index i = 0; i < x_.size(); ++i) ones[i] = x_[i] == 0 && w_[i] == 0;
    const VectorXd along = lcp_.m * ones;
    VectorXd da(x_.size()), db(x_.size());
    for (Index i = 0; i < x_.size(); ++i) {
      const double a = ones[i] > 0 ? 1 : x_[i], b = ones[i] > 0 ? along[i] : w_[i], root = std::hypot(a, b);
      da[i] = a / root - 1;
      db[i] = b / root - 1;
    }
    Eigen::SparseMatrix<double, Eigen::RowMajor> h = db.asDiagonal() * lcp_.m;
    Sparse shift(x_.size(), x_.size());
    shift.setIdentity();
    shift = Sparse((da + epsilon * db).asDiagonal() * shift);
    return Sparse(h) + shift;
  }

  /// Armijo's rule along d.
  bool search(const VectorXd& d, double slope) {
    const VectorXd from = x_;
    const double before = merit();
    double t = 1;
    for (int k = 0; k < 40; ++k, t /= 2) {
      x_ = from + t * d;
      evaluate(x_);
      if (merit() <= before + 1e-4 * t * slope) return true;
    }
    x_ = from;
    evaluate(x_);
    return false;
  }

  const Lcp& lcp_;
  VectorXd x_, w_, phi_;
  Eigen::SparseLU<Sparse> lu_;
};

}  // namespace

LcpSolution solve_fb_newton(const Lcp& lcp, const LcpSettings& settings) {
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 500;
  LcpSolution best;
  best.x = VectorXd::Zero(lcp.size());
  best.error = natural_error(lcp, best.x);
  FischerBurmeister method(lcp);
  while (best.iterations < max && best.error > settings.tolerance && method.step()) {
    stop_if_cancelled();
    ++best.iterations;
    const VectorXd x = method.point();
    const double error = natural_error(lcp, x);
    if (error >= best.error) continue;
    best.error = error;
    best.x = x;
  }
  best.status = best.error <= settings.tolerance ? LcpStatus::solved : LcpStatus::iterations;
  return best;
}

}  // namespace gonogo::sim
