// Methods that need no more than products with W, or one factorisation for many iterations: anderson, apgd, admm,
// jacobi, gauss_seidel and nesterov of solve.h.
#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <deque>

#include "sim/local_problem/algebra/scaled_problem.h"
#include "sim/local_problem/methods/methods.h"
#include "sim/local_problem/problem.h"

namespace gonogo::sim {
namespace {

// Block Gauss-Seidel, extrapolated (Anderson 1965; Walker & Ni 2011, algorithm AA): with sweeps g(r) and f = g(r) - r,
//
//   r_{k+1} = P_K( g_k - sum_j gamma_j (g_{j+1} - g_j) ),  gamma: least squares of f_k on the last f_{j+1} - f_j
//
// A sweep lowers the objective of the convex program. r_{k+1} = g_k where the extrapolation would not lower it further.

using Eigen::MatrixXd;
using Eigen::VectorXd;

class Extrapolation {
 public:
  /// From the latest g and f; at most kMemory differences are kept.
  VectorXd next(const VectorXd& g, const VectorXd& f) {
    if (last_g_.size() > 0) {
      change_g_.push_back(g - last_g_);
      change_f_.push_back(f - last_f_);
      if (change_g_.size() > kMemory) {
        change_g_.pop_front();
        change_f_.pop_front();
      }
    }
    last_g_ = g;
    last_f_ = f;
    if (change_f_.empty()) return g;
    MatrixXd of_f(f.size(), Eigen::Index(change_f_.size()));
    for (std::size_t k = 0; k < change_f_.size(); ++k) of_f.col(Eigen::Index(k)) = change_f_[k];
    const MatrixXd gram = of_f.transpose() * of_f;
    const double lift = 1e-12 * gram.trace();
    const VectorXd gamma =
        (gram + lift * MatrixXd::Identity(gram.rows(), gram.cols())).ldlt().solve(of_f.transpose() * f);
    VectorXd out = g;
    for (std::size_t k = 0; k < change_g_.size(); ++k) out -= gamma[Eigen::Index(k)] * change_g_[k];
    return out;
  }
  void forget() { *this = {}; }

 private:
  static constexpr std::size_t kMemory = 10;
  std::deque<VectorXd> change_g_, change_f_;
  VectorXd last_g_, last_f_;
};

double objective(const LocalProblem& problem, const std::vector<double>& r) {
  return 0.5 * (dot(velocity(problem, r), r) + dot(problem.q, r));
}

VectorXd mapped(const std::vector<double>& r) { return Eigen::Map<const VectorXd>(r.data(), Eigen::Index(r.size())); }

}  // namespace

LocalSolution solve_anderson(const LocalProblem& problem, const LocalSolveSettings& settings) {
  constexpr int kCheckEvery = 10;
  constexpr int kPatience = 5;  // extrapolations in vain, after which they begin anew
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 20000;
  BestSoFar best(problem, settings);
  Extrapolation extrapolation;
  std::vector<double> r = best.best.r;
  int k = 0, in_vain = 0;
  while (k < max && best.best.error > settings.tolerance) {
    const VectorXd from = mapped(r);
    sweep(problem, settings.target, r);
    if (++k % kCheckEvery == 0 || k == max) best.offer(r, k);
    const VectorXd g = mapped(r), next = extrapolation.next(g, g - from);
    std::vector<double> tried(next.begin(), next.end());
    for (Index i = 0; i < problem.contact_count(); ++i)
      project_onto_cone(problem, i, tried.data() + std::size_t(i) * problem.dimension);
    if (objective(problem, tried) < objective(problem, r)) {
      r = std::move(tried);
      in_vain = 0;
    } else if (++in_vain == kPatience) {
      extrapolation.forget();
      in_vain = 0;
    }
  }
  best.best.iterations = k;
  return best.best;
}

namespace {

using Values = std::vector<double>;

/// min 1/2 r W r + (q + s) r over K, by accelerated projected gradients in the metric of one number per contact (so
/// that the projection stays the plain one). The step is 1 / L with L the largest eigenvalue of D^-1/2 W D^-1/2.
class Accelerated {
 public:
  Accelerated(const LocalProblem& problem, Values start)
      : p_(problem), scale_(problem.q.size()), shift_(problem.mu.size(), 0.0), r_(std::move(start)), y_(r_) {
    const int d = p_.dimension;
    for (Index i = 0; i < p_.contact_count(); ++i) {
      double largest = 0;
      for (int a = 0; a < d; ++a) largest = std::max(largest, p_.diagonal_block(i)[a * d + a]);
      std::fill_n(scale_.begin() + std::ptrdiff_t(i) * d, d, 1 / largest);
    }
    const double bound = largest_eigenvalue();
    for (double& s : scale_) s /= bound;
  }

  const Values& impulses() const { return r_; }

  /// Moves s by `share` of the way to sum c_d |u_d| of the present impulses; it is added to the normal velocities.
  void follow_slip(double share) {
    const Values u = velocity(p_, r_);
    for (Index i = 0; i < p_.contact_count(); ++i)
      shift_[i] += share * (de_saxce_term(p_, i, u.data() + std::size_t(i) * p_.dimension) - shift_[i]);
    theta_ = 1;
    y_ = r_;
  }

  /// One step; returns the size of the change in the metric, relative to the impulses'.
  double step() {
    const Values gradient = shifted_velocity(y_);
    Values next(r_.size());
    for (Index i = 0; i < p_.contact_count(); ++i) project(gradient, i, next);
    double ahead = 0, change = 0, size = 0;  // of r_{k+1} - r_k along the gradient: uphill means restart
    for (std::size_t i = 0; i < r_.size(); ++i) {
      ahead += gradient[i] * (next[i] - r_[i]);
      change += (next[i] - y_[i]) * (next[i] - y_[i]) / scale_[i];
      size += next[i] * next[i] / scale_[i];
    }
    momentum(next, ahead > 0);
    return size > 0 ? std::sqrt(change / size) : 0;
  }

 private:
  Values shifted_velocity(const Values& r) const {
    Values u = velocity(p_, r);
    for (Index i = 0; i < p_.contact_count(); ++i) u[std::size_t(i) * p_.dimension] += shift_[i];
    return u;
  }

  void project(const Values& gradient, Index i, Values& next) const {
    const std::size_t at = std::size_t(i) * p_.dimension;
    for (int a = 0; a < p_.dimension; ++a) next[at + a] = y_[at + a] - scale_[at + a] * gradient[at + a];
    project_onto_cone(p_, i, next.data() + at);
  }

  /// Nesterov's sequence, begun again on the way uphill (O'Donoghue & Candes 2015).
  void momentum(const Values& next, bool restart) {
    const double theta = restart ? 1 : theta_;
    const double following = theta * (std::sqrt(theta * theta + 4) - theta) / 2;
    const double beta = restart ? 0 : theta * (1 - theta) / (theta * theta + following);
    for (std::size_t i = 0; i < r_.size(); ++i) y_[i] = next[i] + beta * (next[i] - r_[i]);
    r_ = next;
    theta_ = following;
  }

  /// Largest eigenvalue of D^-1 W, by the power method from a fixed start, with a margin; at most the largest row sum.
  double largest_eigenvalue() const {
    Values x(r_.size());
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 1 + 0.5 * std::sin(double(i + 1));
    double value = 1;
    LocalProblem free = p_;
    std::fill(free.q.begin(), free.q.end(), 0.0);
    for (int k = 0; k < 100; ++k) {
      Values next = velocity(free, x);
      for (std::size_t i = 0; i < x.size(); ++i) next[i] *= scale_[i];
      value = std::sqrt(dot(next, next) / dot(x, x));
      const double length = std::sqrt(dot(next, next));
      if (!(length > 0)) return 1;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = next[i] / length;
    }
    return 1.05 * value;
  }

  const LocalProblem& p_;
  Values scale_, shift_, r_, y_;
  double theta_ = 1;
};

/// When to let De Saxce's term follow the slip, and how far.
class SlipFollowing {
 public:
  explicit SlipFollowing(double finest) : finest_(finest) {}

  bool due(double change) const { return change < allowed_; }
  double share() const { return share_; }

  /// After following at this error: in vain, the next time waits for a better converged program; in vain for long,
  /// shorter steps end the turns that slip and impulses can take for ever.
  void judge(double lowest_error) {
    if (lowest_error < 0.9 * lowest_) {
      lowest_ = lowest_error;
      in_vain_ = 0;
      return;
    }
    allowed_ = std::max(allowed_ / 2, finest_);
    if (++in_vain_ < kPatience) return;
    share_ = std::max(share_ / 2, 0.02);
    in_vain_ = 0;
  }

 private:
  static constexpr int kPatience = 30;
  double finest_, allowed_ = 1e-2, share_ = 1, lowest_ = 1e300;  // allowed: change per step, relative
  int in_vain_ = 0;
};

}  // namespace

LocalSolution solve_apgd(const LocalProblem& problem, const LocalSolveSettings& settings) {
  constexpr int kCheckEvery = 10;
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 100000;
  BestSoFar best(problem, settings);
  Accelerated method(problem, best.best.r);
  SlipFollowing slip(1e-4 * settings.tolerance);
  int k = 0;
  while (k < max && best.best.error > settings.tolerance) {
    const double change = method.step();
    if (++k % kCheckEvery == 0 || k == max) best.offer(method.impulses(), k);
    if (settings.target == Target::ccp || !slip.due(change)) continue;
    best.offer(method.impulses(), k);
    slip.judge(best.best.error);
    method.follow_slip(slip.share());
  }
  best.best.iterations = k;
  return best.best;
}

// Alternating directions on the split r in K:
//
//   x = (W + rho + eta)^-1 (rho z - y + eta x - q - s),  z = P_K(x + y / rho),  y = y + rho (x - z)
//
// with -y -> u + s and, for `coulomb`, s_n = sum c_d |y_d| renewed at every iteration (Carpentier, Montaut & Le Lidec
// 2024). rho follows the balance of the residuals |x - z| and rho |z - z_before| (Boyd et al. 2011, 3.4.1); the matrix
// is factorised anew only then.

namespace {

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

// Methods of the literature as published, for the convex relaxation, to compare with its tables:
//
//   jacobi, gauss_seidel   fixed point with relaxation omega and smoothing lambda (Tasora & Anitescu 2011, section 4):
//                            r_i <- lambda P_K(r_i - omega eta_i (W r + q)_i) + (1 - lambda) r_i,  eta_i = d / trace
//                            W_ii
//   nesterov               accelerated projected gradients with step search, fall-back and best iterate (Mazhar, Heyn,
//                          Negrut & Tasora 2015, algorithm 1)

namespace {

Values difference(const Values& a, const Values& b) {
  Values d(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
  return d;
}

/// r_i from the velocity u[dimension] of its contact.
void relax(const LocalProblem& p, Index i, double omega, double lambda, const double* u, double* r) {
  double trace = 0, next[5];
  for (int a = 0; a < p.dimension; ++a) trace += p.diagonal_block(i)[a * p.dimension + a];
  const double step = omega * p.dimension / trace;
  for (int a = 0; a < p.dimension; ++a) next[a] = r[a] - step * u[a];
  project_onto_cone(p, i, next);
  for (int a = 0; a < p.dimension; ++a) r[a] = lambda * next[a] + (1 - lambda) * r[a];
}

/// Nesterov's method of 2015, step by step.
class Nesterov {
 public:
  explicit Nesterov(const LocalProblem& p) : p_(p), r_(p.q.size(), 0.0), y_(r_) {
    const Values ones(r_.size(), 1.0);  // L_0 = |W (r_0 - 1)| / |r_0 - 1|
    const Values image = difference(velocity(p_, ones), p_.q);
    curvature_ = std::sqrt(dot(image, image) / dot(ones, ones));
  }

  const Values& impulses() const { return r_; }

  void step() {
    const Values gradient = velocity(p_, y_), before = r_;
    const double at_y = 0.5 * (dot(gradient, y_) + dot(p_.q, y_));
    for (int k = 0; k < 100; ++k, curvature_ *= 2) {
      r_ = projected(gradient);
      const Values d = difference(r_, y_), u = velocity(p_, r_);
      if (0.5 * (dot(u, r_) + dot(p_.q, r_)) <= at_y + dot(gradient, d) + 0.5 * curvature_ * dot(d, d)) break;
    }
    const double square = theta_ * theta_, next = (-square + theta_ * std::sqrt(square + 4)) / 2;
    const double beta = theta_ * (1 - theta_) / (square + next);
    theta_ = next;
    const Values change = difference(r_, before);
    for (std::size_t i = 0; i < r_.size(); ++i) y_[i] = r_[i] + beta * change[i];
    if (dot(gradient, change) > 0) {
      y_ = r_;
      theta_ = 1;
    }
    curvature_ *= 0.9;
  }

 private:
  Values projected(const Values& gradient) const {
    Values next(r_.size());
    for (std::size_t i = 0; i < next.size(); ++i) next[i] = y_[i] - gradient[i] / curvature_;
    for (Index i = 0; i < p_.contact_count(); ++i)
      project_onto_cone(p_, i, next.data() + std::size_t(i) * p_.dimension);
    return next;
  }

  const LocalProblem& p_;
  Values r_, y_;
  double theta_ = 1, curvature_ = 1;
};

/// Offers the impulses of `method` after each tenth step until the tolerance or the limit.
template <class Step>
LocalSolution iterate(const LocalProblem& problem, const LocalSolveSettings& settings, Values& r, Step step) {
  constexpr int kCheckEvery = 10;
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 100000;
  BestSoFar best(problem, settings);
  int k = 0;
  while (k < max && best.best.error > settings.tolerance) {
    step();
    if (++k % kCheckEvery == 0 || k == max) best.offer(r, k);
  }
  best.best.iterations = k;
  return best.best;
}

}  // namespace

LocalSolution solve_jacobi(const LocalProblem& problem, const LocalSolveSettings& settings) {
  const double omega = settings.omega > 0 ? settings.omega : 0.2;
  Values r(problem.q.size(), 0.0);
  return iterate(problem, settings, r, [&] {
    const Values u = velocity(problem, r);
    for (Index i = 0; i < problem.contact_count(); ++i) {
      const std::size_t k = std::size_t(i) * problem.dimension;
      relax(problem, i, omega, settings.lambda, u.data() + k, r.data() + k);
    }
  });
}

LocalSolution solve_gauss_seidel(const LocalProblem& problem, const LocalSolveSettings& settings) {
  const int d = problem.dimension;
  const double omega = settings.omega > 0 ? settings.omega : 1;
  Values r(problem.q.size(), 0.0);
  return iterate(problem, settings, r, [&] {
    ContactVelocities velocities(problem, r);
    for (Index i = 0; i < problem.contact_count(); ++i) {
      double u[5], before[5], *const ri = r.data() + std::size_t(i) * d;
      velocities.at(i, u);
      std::copy_n(ri, d, before);
      relax(problem, i, omega, settings.lambda, u, ri);
      velocities.changed(i, before);
    }
  });
}

LocalSolution solve_nesterov(const LocalProblem& problem, const LocalSolveSettings& settings) {
  Nesterov method(problem);
  Values r(problem.q.size(), 0.0);
  return iterate(problem, settings, r, [&] {
    method.step();
    r = method.impulses();
  });
}

}  // namespace gonogo::sim
