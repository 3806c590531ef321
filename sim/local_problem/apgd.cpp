#include <algorithm>
#include <array>
#include <cmath>

#include "sim/local_problem/methods.h"

namespace gonogo::sim {
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

  /// Of D^-1 W, by the power method from a fixed start, with a margin; at most the largest row sum.
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

}  // namespace

namespace {

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

}  // namespace gonogo::sim
