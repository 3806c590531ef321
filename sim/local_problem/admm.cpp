// Alternating directions on the split r in K:
//
//   x = (W + rho + eta)^-1 (rho z - y + eta x - q - s),  z = P_K(x + y / rho),  y = y + rho (x - z)
//
// with -y -> u + s and, for `coulomb`, s_n = sum c_d |y_d| renewed at every iteration (Carpentier, Montaut & Le Lidec
// 2024). rho follows the balance of the residuals |x - z| and rho |z - z_before| (Boyd et al. 2011, 3.4.1); the matrix
// is factorised anew only then.
#include <Eigen/SparseLU>

#include "sim/local_problem/methods.h"
#include "sim/local_problem/scaled_problem.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

class AlternatingDirections {
 public:
  AlternatingDirections(const LocalProblem& p, Target target) : p_(p), target_(target), of_(p) {
    x_ = z_ = y_ = VectorXd::Zero(of_.q.size());
    identity_.resize(of_.w.rows(), of_.w.cols());
    identity_.setIdentity();
    factorise();
  }

  bool is_factorised() const { return factor_.info() == Eigen::Success; }
  std::vector<double> impulses() const { return of_.impulses(z_); }

  void step() {
    VectorXd rhs = rho_ * z_ - y_ + kEta * x_ - of_.q;
    const int d = p_.dimension;
    for (Index i = 0; i < p_.contact_count() && target_ == Target::coulomb; ++i)
      rhs[i * d] -= de_saxce_term(p_, i, y_.data() + i * d);
    x_ = factor_.solve(rhs);
    const VectorXd before = z_;
    z_ = x_ + y_ / rho_;
    for (Index i = 0; i < p_.contact_count(); ++i) project_onto_cone(p_, i, z_.data() + i * d);
    y_ += rho_ * (x_ - z_);
    primal_ = (x_ - z_).lpNorm<Eigen::Infinity>();
    dual_ = rho_ * (z_ - before).lpNorm<Eigen::Infinity>();
  }

  /// Moves rho towards the balance when the residuals are far apart; at most by kMaxFactor.
  void balance() {
    constexpr double kMaxFactor = 50, kWorthwhile = 2;
    if (!(primal_ > 0) || !(dual_ > 0)) return;
    const double factor = std::clamp(std::sqrt(primal_ / dual_), 1 / kMaxFactor, kMaxFactor);
    if (factor < kWorthwhile && factor > 1 / kWorthwhile) return;
    rho_ = std::clamp(rho_ * factor, 1e-8, 1e8);
    factorise();
  }

 private:
  void factorise() { factor_.compute(Sparse(of_.w + (rho_ + kEta) * identity_)); }

  static constexpr double kEta = 1e-9;  // keeps the matrix regular when rho is small
  const LocalProblem& p_;
  Target target_;
  ScaledProblem of_;
  Sparse identity_;
  VectorXd x_, z_, y_;
  double rho_ = 0.1, primal_ = 0, dual_ = 0;
  Eigen::SparseLU<Sparse> factor_;  // not Cholesky: W of some files is symmetric to 1e-3 only
};

}  // namespace

LocalSolution solve_admm(const LocalProblem& problem, const LocalSolveSettings& settings) {
  constexpr int kCheckEvery = 10, kBalanceEvery = 50;  // a balance restarts the convergence of y: not too often
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 20000;
  BestSoFar best(problem, settings);
  AlternatingDirections method(problem, settings.target);
  int k = 0;
  while (k < max && best.best.error > settings.tolerance && method.is_factorised()) {
    method.step();
    if (++k % kCheckEvery == 0 || k == max) best.offer(method.impulses(), k);
    if (k % kBalanceEvery == 0) method.balance();
  }
  best.best.iterations = k;
  return best.best;
}

}  // namespace gonogo::sim
