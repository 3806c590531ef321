// Methods of the literature as published, for the convex relaxation, to compare with its tables:
//
//   jacobi, gauss_seidel   fixed point with relaxation omega and smoothing lambda (Tasora & Anitescu 2011, section 4):
//                            r_i <- lambda P_K(r_i - omega eta_i (W r + q)_i) + (1 - lambda) r_i,  eta_i = d / trace
//                            W_ii
//   nesterov               accelerated projected gradients with step search, fall-back and best iterate (Mazhar, Heyn,
//                          Negrut & Tasora 2015, algorithm 1)
#include <algorithm>
#include <cmath>

#include "sim/local_problem/body_form.h"
#include "sim/local_problem/methods.h"

namespace gonogo::sim {
namespace {

using Values = std::vector<double>;

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

LocalSolution solve_fixed_point(const LocalProblem& problem, const LocalSolveSettings& settings) {
  const int d = problem.dimension;
  const bool by_jacobi = settings.solver == LocalSolver::jacobi;
  const double omega = settings.omega > 0 ? settings.omega : by_jacobi ? 0.2 : 1;
  Values r(problem.q.size(), 0.0);
  return iterate(problem, settings, r, [&] {
    if (by_jacobi) {
      const Values u = velocity(problem, r);
      for (std::size_t k = 0; k < r.size(); k += std::size_t(d))
        relax(problem, Index(k) / d, omega, settings.lambda, u.data() + k, r.data() + k);
      return;
    }
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
