// Block Gauss-Seidel, extrapolated (Anderson 1965; Walker & Ni 2011, algorithm AA): with sweeps g(r) and f = g(r) - r,
//
//   r_{k+1} = P_K( g_k - sum_j gamma_j (g_{j+1} - g_j) ),  gamma: least squares of f_k on the last f_{j+1} - f_j
//
// A sweep lowers the objective of the convex program. r_{k+1} = g_k where the extrapolation would not lower it further.
#include <Eigen/Dense>
#include <deque>

#include "sim/local_problem/methods.h"

namespace gonogo::sim {
namespace {

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

}  // namespace gonogo::sim
