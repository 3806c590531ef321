#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <cmath>
#include <optional>

#include "sim/local_problem/methods/methods.h"
#include "sim/local_problem/one_contact.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;

/// cone_function() over all contacts, for the problem with u = (W + alpha D) r + q - alpha D centre.
class RegularisedProblem {
 public:
  RegularisedProblem(const LocalProblem& problem, Target target)
      : p_(problem), target_(target), weight_(diagonal_weight(problem)), f_(problem.q.size()) {}

  void regularise(double alpha, const std::vector<double>& centre) {
    alpha_ = alpha;
    centre_ = centre;
  }

  /// F in the root of energy, |D^1/2 F|: comparable between contacts of unlike masses.
  double merit(const std::vector<double>& r) {
    u_ = velocity(p_, r);
    for (std::size_t i = 0; i < r.size(); ++i) u_[i] += alpha_ * weight_[i] * (r[i] - centre_[i]);
    active_ = 0;
    place_.assign(p_.contact_count(), -1);
    for (Index i = 0; i < p_.contact_count(); ++i) {
      const std::size_t at = start(i);
      const bool opens =
          cone_function(p_, i, target_, &weight_[at], r.data() + at, u_.data() + at, f_.data() + at, nullptr);
      if (!opens) place_[i] = active_++;
    }
    double sum = 0;
    for (std::size_t i = 0; i < r.size(); ++i) sum += weight_[i] * f_[i] * f_[i];
    return std::sqrt(sum);
  }

  /// One full Newton step from the point of the last merit(); false when the matrix is singular. Contacts that open
  /// have the step -F = -r and leave the linear system.
  bool step(std::vector<double>& r) const {
    std::vector<double> change(r.size());
    for (std::size_t i = 0; i < r.size(); ++i) change[i] = place_[i / p_.dimension] < 0 ? -f_[i] : 0;
    if (active_ > 0) {
      const std::optional<VectorXd> x = solve_active(r, change);
      if (!x) return false;
      for (Index i = 0; i < p_.contact_count(); ++i)
        for (int a = 0; a < p_.dimension && place_[i] >= 0; ++a)
          change[start(i) + a] = (*x)[place_[i] * p_.dimension + a];
    }
    for (std::size_t i = 0; i < r.size(); ++i) r[i] += change[i];
    return true;
  }

 private:
  std::size_t start(Index contact) const { return std::size_t(contact) * p_.dimension; }

  /// Rows of the active contacts: (by_u (W + alpha D) + by_r) x = -F - by_u W change, with the changes of the others.
  std::optional<VectorXd> solve_active(const std::vector<double>& r, const std::vector<double>& change) const {
    VectorXd rhs(active_ * p_.dimension);
    std::vector<Eigen::Triplet<double>> entry;
    for (Index i = 0; i < p_.contact_count(); ++i)
      if (place_[i] >= 0) add_rows(r, change, i, entry, rhs);
    Eigen::SparseMatrix<double> jacobian(rhs.size(), rhs.size());
    jacobian.setFromTriplets(entry.begin(), entry.end());
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(jacobian);
    if (lu.info() != Eigen::Success) return std::nullopt;
    VectorXd x = lu.solve(rhs);
    if (!x.allFinite()) return std::nullopt;
    return x;
  }

  void add_rows(const std::vector<double>& r, const std::vector<double>& change, Index i,
                std::vector<Eigen::Triplet<double>>& entry, VectorXd& rhs) const {
    const int d = p_.dimension;
    double f[5];
    ConeDerivative derivative;
    cone_function(p_, i, target_, &weight_[start(i)], r.data() + start(i), u_.data() + start(i), f, &derivative);
    ContactVector known = ContactVector::Zero(d);
    for (Index k = p_.w.first[i]; k < p_.w.first[i + 1]; ++k) {
      const Index j = p_.w.column[k];
      ContactMatrix block = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
          p_.w.value.data() + std::size_t(k) * d * d, d, d);
      if (place_[j] < 0) {
        known += block * Eigen::Map<const VectorXd>(change.data() + start(j), d);
        continue;
      }
      for (int a = 0; a < d && j == i; ++a) block(a, a) += alpha_ * weight_[start(i) + a];
      ContactMatrix jacobian = derivative.by_u * block;
      if (j == i) jacobian += derivative.by_r;
      for (int a = 0; a < d; ++a)
        for (int b = 0; b < d; ++b)
          if (jacobian(a, b) != 0) entry.emplace_back(place_[i] * d + a, place_[j] * d + b, jacobian(a, b));
    }
    rhs.segment(place_[i] * d, d) = -Eigen::Map<const VectorXd>(f, d) - derivative.by_u * known;
  }

  const LocalProblem& p_;
  Target target_;
  std::vector<double> weight_;
  double alpha_ = 0;
  std::vector<double> centre_, u_, f_;
  std::vector<Index> place_;  // of an active contact in the linear system; -1: opens
  Index active_ = 0;
};

/// How much regularisation Newton needs: less after success, more after failure, and three successes before an alpha
/// that failed is tried again.
class Regularisation {
 public:
  double alpha() const { return alpha_; }
  bool is_at_max() const { return alpha_ >= kMax; }
  void restart() { *this = {}; }
  void succeeded() {
    ++successes_;
    if (alpha_ / kFactor > 1.01 * failed_ || successes_ >= 3) {
      alpha_ /= kFactor;
      successes_ = 0;
    }
  }
  void failed() {
    failed_ = alpha_;
    successes_ = 0;
    alpha_ = std::min(alpha_ * kFactor, kMax);
  }

 private:
  static constexpr double kFactor = 3, kMax = 1;
  double alpha_ = 1e-2, failed_ = 0;
  int successes_ = 0;
};

/// Full steps only: where they fail within a dozen, more regularisation serves better than a line search does.
bool newton(RegularisedProblem& f, std::vector<double>& r, int& steps) {
  constexpr int kMaxSteps = 12;
  const double start = f.merit(r);
  double now = start;
  for (int k = 0; k < kMaxSteps && now > 1e-4 * start; ++k, ++steps) {
    if (!f.step(r)) return false;
    now = f.merit(r);
    if (!std::isfinite(now)) return false;
  }
  return now <= 1e-4 * start;
}

/// Proximal points from `r` with at most `max` Newton steps, counted in `best`; `rescue` is called where no
/// regularisation helps, and ends the method when it returns false.
template <class Rescue>
void proximal_points(const LocalProblem& problem, const LocalSolveSettings& settings, int max, std::vector<double>& r,
                     BestSoFar& best, Rescue rescue) {
  constexpr double kJump = 3;  // a growth of the error beyond this is another branch of solutions: refused
  RegularisedProblem f(problem, settings.target);
  Regularisation regularisation;
  double error = best.offer(r, best.best.iterations);
  int steps = 0;
  while (steps < max && best.best.error > settings.tolerance) {
    f.regularise(regularisation.alpha(), r);
    std::vector<double> next = r;
    const int before = steps;
    const bool converged = newton(f, next, steps);
    if (steps == before) break;  // r solves the regularised problem within rounding: nothing is left to gain
    const double next_error = converged ? best.offer(next, best.best.iterations + steps) : 0;
    if (converged && next_error < kJump * error) {
      r = next;
      error = next_error;
      regularisation.succeeded();
    } else if (regularisation.is_at_max()) {
      if (!rescue(r, error)) break;
      regularisation.restart();
    } else {
      regularisation.failed();
    }
  }
  best.best.iterations += steps;
}

}  // namespace

void finish_by_proximal_points(const LocalProblem& problem, const LocalSolveSettings& settings, int max,
                               BestSoFar& best) {
  std::vector<double> r = best.best.r;
  proximal_points(problem, settings, max, r, best, [](std::vector<double>&, double&) { return false; });
}

LocalSolution solve_ppa(const LocalProblem& problem, const LocalSolveSettings& settings) {
  constexpr int kSweeps = 200, kCheckEvery = 10;
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 4000;
  BestSoFar best(problem, settings);
  std::vector<double> r = best.best.r;
  double error = best.best.error;
  const auto sweeps = [&](std::vector<double>& at, double& its_error) {
    for (int k = 1; k <= kSweeps && its_error > settings.tolerance; ++k) {
      sweep(problem, settings.target, at);
      if (k % kCheckEvery == 0) its_error = best.offer(at, best.best.iterations + k);
    }
    return true;
  };
  sweeps(r, error);
  proximal_points(problem, settings, max, r, best, sweeps);
  return best.best;
}

}  // namespace gonogo::sim
