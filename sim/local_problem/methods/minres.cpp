// A minimal-residual Krylov method for the convex cone program, after Heyn, Anitescu, Tasora & Negrut (2013): gradients
// find the face of the cone that the solution lies on, MINRES solves for the minimum on it.
//
// On a face the free directions of a contact are: none where r = 0; all inside the cone; for a disc on its bound the
// ray e_n + c t and the direction across t, in which the bound bends. Its bend adds |u_d| / |r_d| to the curvature of
// the objective there (the Lagrangian's), so that steps from a near point converge quadratically.
#include <unsupported/Eigen/IterativeSolvers>

#include "sim/local_problem/algebra/scaled_problem.h"
#include "sim/local_problem/methods/methods.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

/// Z, the free directions as columns, and what the bends add to the diagonal of Z^T W Z.
struct Face {
  Sparse directions;
  VectorXd bend;
};

class ProjectedMinres {
 public:
  explicit ProjectedMinres(const LocalProblem& p)
      : p_(p), of_(p), r_(VectorXd::Zero(of_.q.size())), bound_(largest_eigenvalue()) {}

  bool is_symmetric() const { return (of_.w - Sparse(of_.w.transpose())).norm() <= 1e-12 * of_.w.norm(); }
  std::vector<double> impulses() const { return of_.impulses(r_); }
  long products() const { return products_; }

  /// Gradient steps until the face rests or `most` are done, then MINRES on the face.
  void step(int most) {
    std::vector<char> before;
    for (int k = 0; k < most; ++k) {
      r_ = projected(r_ - gradient(r_) / bound_);
      const std::vector<char> now = states();
      if (now == before) break;
      before = now;
    }
    descend_on_face();
  }

 private:
  VectorXd gradient(const VectorXd& r) {
    ++products_;
    return of_.w * r + of_.q;
  }
  double objective(const VectorXd& r) { return 0.5 * r.dot(gradient(r) + of_.q); }

  VectorXd projected(VectorXd r) const {
    for (Index i = 0; i < p_.contact_count(); ++i) project_onto_cone(p_, i, r.data() + Eigen::Index(i) * p_.dimension);
    return r;
  }

  bool is_open(Index i) const { return !(r_[Eigen::Index(i) * p_.dimension] > 0); }
  double length(Index i, int d) const {
    return r_.segment(Eigen::Index(i) * p_.dimension + p_.disc(d).first, p_.disc(d).size).norm();
  }
  bool is_on_bound(Index i, int d) const {
    const double bound = p_.coefficient(i, d) * r_[Eigen::Index(i) * p_.dimension];
    return length(i, d) >= (1 - 1e-12) * bound;
  }

  /// Per contact: 0 open, otherwise 1 + a bit per disc on its bound.
  std::vector<char> states() const {
    std::vector<char> state;
    for (Index i = 0; i < p_.contact_count(); ++i) {
      char code = is_open(i) ? 0 : 1;
      for (int d = 0; d < p_.disc_count() && code > 0; ++d) code = char(code + (is_on_bound(i, d) ? 2 << d : 0));
      state.push_back(code);
    }
    return state;
  }

  Face face(const VectorXd& u) const {
    Entries entry;
    std::vector<double> bend;
    for (Index i = 0; i < p_.contact_count(); ++i) {
      if (is_open(i)) continue;
      const Eigen::Index normal = Eigen::Index(i) * p_.dimension, ray = Eigen::Index(bend.size());
      entry.emplace_back(normal, ray, 1);
      bend.push_back(0);
      for (int d = 0; d < p_.disc_count(); ++d) add_disc(i, d, ray, u, entry, bend);
    }
    Face out;
    out.directions.resize(r_.size(), Eigen::Index(bend.size()));
    out.directions.setFromTriplets(entry.begin(), entry.end());
    out.bend = Eigen::Map<const VectorXd>(bend.data(), Eigen::Index(bend.size()));
    return out;
  }

  void add_disc(Index i, int d, Eigen::Index ray, const VectorXd& u, Entries& entry, std::vector<double>& bend) const {
    const FrictionDisc disc = p_.disc(d);
    const Eigen::Index row = Eigen::Index(i) * p_.dimension + disc.first;
    if (!(p_.coefficient(i, d) > 0)) return;
    if (!is_on_bound(i, d)) {
      for (int a = 0; a < disc.size; ++a, bend.push_back(0)) entry.emplace_back(row + a, Eigen::Index(bend.size()), 1);
      return;
    }
    const VectorXd t = r_.segment(row, disc.size).normalized();
    for (int a = 0; a < disc.size; ++a) entry.emplace_back(row + a, ray, p_.coefficient(i, d) * t[a]);
    if (disc.size == 1) return;
    entry.emplace_back(row, Eigen::Index(bend.size()), -t[1]);
    entry.emplace_back(row + 1, Eigen::Index(bend.size()), t[0]);
    bend.push_back(std::max(0.0, -u.segment(row, 2).dot(t)) / length(i, d));
  }

  void descend_on_face() {
    const VectorXd u = gradient(r_);
    const Face on = face(u);
    if (on.bend.size() == 0) return;
    const Sparse image = of_.w * on.directions;
    Sparse matrix = Sparse(on.directions.transpose() * image);
    for (Eigen::Index k = 0; k < on.bend.size(); ++k) matrix.coeffRef(k, k) += on.bend[k];
    Eigen::MINRES<Sparse, Eigen::Lower | Eigen::Upper, Eigen::IdentityPreconditioner> minres(matrix);
    minres.setTolerance(1e-10);
    minres.setMaxIterations(std::max<Eigen::Index>(50, on.bend.size()));
    const VectorXd rhs = -(on.directions.transpose() * u);
    if (!(rhs.norm() > 0)) return;
    const VectorXd step = on.directions * VectorXd(minres.solve(rhs));
    products_ += minres.iterations();
    if (!step.allFinite()) return;
    const double before = objective(r_);
    for (double t = 1; t > 1e-3; t /= 2) {
      const VectorXd next = projected(r_ + t * step);
      if (objective(next) > before) continue;
      r_ = next;
      return;
    }
  }

  double largest_eigenvalue() const {
    VectorXd x = VectorXd::LinSpaced(of_.q.size(), 1, 2);
    double value = 1;
    for (int k = 0; k < 100; ++k) {
      const VectorXd next = of_.w * x;
      value = next.norm() / x.norm();
      x = next.normalized();
    }
    return 1.05 * value;
  }

  const LocalProblem& p_;
  ScaledProblem of_;
  VectorXd r_;
  double bound_;
  long products_ = 0;
};

}  // namespace

LocalSolution solve_minres(const LocalProblem& problem, const LocalSolveSettings& settings) {
  constexpr int kGradients = 20;
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 2000;
  BestSoFar best(problem, settings);
  ProjectedMinres method(problem);
  if (!method.is_symmetric()) {
    best.best.refusal = "minres refuses a matrix W that is not symmetric; take pdip or nesterov";
    return best.best;
  }
  int k = 0;
  while (k < max && best.best.error > settings.tolerance) {
    method.step(kGradients);
    best.offer(method.impulses(), ++k);
  }
  best.best.iterations = k;
  best.best.linear.inner_iterations = method.products();
  return best.best;
}

}  // namespace gonogo::sim
