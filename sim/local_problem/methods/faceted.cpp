#include "sim/local_problem/methods/faceted.h"

#include <numbers>

#include "sim/local_problem/methods/methods.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;
using Entry = Eigen::Triplet<double>;
using Entries = std::vector<Entry>;

}  // namespace

FacetedProblem::FacetedProblem(const LocalProblem& problem, Target target, int facets)
    : p_(problem), target_(target), facets_(facets), of_(problem) {
  lay_out();
  make_generators();
}

Eigen::Vector2d FacetedProblem::direction(const Polygon& polygon, int j) const {
  if (polygon.size == 1) return {j == 0 ? 1 : -1, 0};
  const double angle = 2 * std::numbers::pi * j / facets_;
  return {std::cos(angle), std::sin(angle)};
}

void FacetedProblem::lay_out() {
  Entries entry;
  Eigen::Index next = 0;
  for (Eigen::Index i = 0; i < p_.contact_count(); ++i) {
    const Eigen::Index normal = i * p_.dimension, x_normal = next++;
    x_normal_.push_back(x_normal);
    entry.emplace_back(normal, x_normal, 1);
    for (int d = 0; d < p_.disc_count(); ++d) {
      if (!(p_.coefficient(int(i), d) > 0)) continue;
      Polygon polygon{.normal = normal, .x_normal = x_normal, .x = next};
      polygon.first = p_.disc(d).first;
      polygon.size = p_.disc(d).size;
      polygon.c = p_.coefficient(int(i), d);
      for (int j = 0; j < directions(polygon); ++j, ++next)
        for (int a = 0; a < polygon.size; ++a)
          entry.emplace_back(normal + polygon.first + a, next, direction(polygon, j)[a]);
      polygon.lambda = next++;
      polygons_.push_back(polygon);
    }
  }
  rays_.resize(of_.q.size(), next);
  rays_.setFromTriplets(entry.begin(), entry.end());
}

void FacetedProblem::make_generators() {
  Entries ray, split;
  Eigen::Index next = 0;
  std::size_t k = 0;
  for (Eigen::Index i = 0; i < p_.contact_count(); ++i) {
    const Eigen::Index normal = i * p_.dimension;
    std::vector<const Polygon*> of_contact;
    for (; k < polygons_.size() && polygons_[k].normal == normal; ++k) of_contact.push_back(&polygons_[k]);
    int count = 1;  // one generator per choice of a direction on every disc
    for (const Polygon* polygon : of_contact) count *= directions(*polygon);
    for (int choice = 0; choice < count; ++choice, ++next) {
      ray.emplace_back(normal, next, 1);
      split.emplace_back(x_normal_[std::size_t(i)], next, 1);
      int rest = choice;
      for (const Polygon* polygon : of_contact) {
        const int j = rest % directions(*polygon);
        rest /= directions(*polygon);
        split.emplace_back(polygon->x + j, next, polygon->c);
        for (int a = 0; a < polygon->size; ++a)
          ray.emplace_back(normal + polygon->first + a, next, polygon->c * direction(*polygon, j)[a]);
      }
    }
  }
  generators_.resize(of_.q.size(), next);
  generators_.setFromTriplets(ray.begin(), ray.end());
  split_.resize(rays_.cols(), next);
  split_.setFromTriplets(split.begin(), split.end());
}

Lcp FacetedProblem::multiplier_form() const {
  Entries entry;
  for (const Polygon& polygon : polygons_) {
    for (int j = 0; j < directions(polygon); ++j) {
      entry.emplace_back(polygon.x + j, polygon.lambda, 1);
      entry.emplace_back(polygon.lambda, polygon.x + j, -1);
    }
    entry.emplace_back(polygon.lambda, polygon.x_normal, polygon.c);
    if (target_ == Target::ccp) entry.emplace_back(polygon.x_normal, polygon.lambda, -polygon.c);
  }
  Eigen::SparseMatrix<double> law(rays_.cols(), rays_.cols());
  law.setFromTriplets(entry.begin(), entry.end());
  const Eigen::SparseMatrix<double> image = of_.w * rays_;
  return {Eigen::SparseMatrix<double>(Eigen::SparseMatrix<double>(rays_.transpose() * image) + law),
          rays_.transpose() * of_.q};
}

Lcp FacetedProblem::generator_form() const {
  const Eigen::SparseMatrix<double> image = of_.w * generators_;
  return {Eigen::SparseMatrix<double>(generators_.transpose() * image), generators_.transpose() * of_.q};
}

double FacetedProblem::facet_speed(const Polygon& polygon, const VectorXd& u) const {
  double fastest = 0;
  for (int j = 0; j < directions(polygon); ++j) {
    double along = 0;
    for (int a = 0; a < polygon.size; ++a) along += direction(polygon, j)[a] * u[polygon.normal + polygon.first + a];
    fastest = std::max(fastest, -along);
  }
  return fastest;
}

VectorXd FacetedProblem::slip_shift(const VectorXd& r) const {
  VectorXd shift = VectorXd::Zero(of_.q.size());
  if (target_ == Target::coulomb) {
    const VectorXd u = of_.w * r + of_.q;
    for (const Polygon& polygon : polygons_) shift[polygon.normal] += polygon.c * facet_speed(polygon, u);
  }
  return generators_.transpose() * shift;
}

VectorXd FacetedProblem::multipliers_of(const VectorXd& gamma) const {
  VectorXd x = split_ * gamma;
  const VectorXd r = generators_ * gamma, u = of_.w * r + of_.q;
  for (const Polygon& polygon : polygons_) x[polygon.lambda] = facet_speed(polygon, u);
  return x;
}

bool FacetedProblem::is_symmetric() const {
  constexpr double kRounding = 1e-12;
  return (of_.w - Eigen::SparseMatrix<double>(of_.w.transpose())).norm() <= kRounding * of_.w.norm();
}

// The LCP family on the polygons of faceted.h: lemke and fb_newton on the form with multipliers; pgs and qp on the one
// with generators, where `coulomb` is a sequence of convex programs.

namespace {

std::string too_large(LocalSolver solver, Eigen::Index unknowns, Eigen::Index most) {
  return std::string(solver_name(solver)) + " refuses " + std::to_string(unknowns) + " unknowns, more than " +
         std::to_string(most) + "; take fewer facets, pgs, or a solver of the round cone";
}

/// Most unknowns: lemke and qp keep dense matrices and need up to as many pivots; fb_newton factorises a matrix with
/// dense blocks of a contact's facets.
Eigen::Index most_unknowns(Complementarity by) {
  if (by == Complementarity::pgs) return 200000;
  return by == Complementarity::lemke ? 2000 : by == Complementarity::qp ? 4000 : 10000;
}

/// Convex programs with the slip's share in the normal velocities, until they agree.
LcpSolution follow_slip(const FacetedProblem& faceted, const LocalSolveSettings& settings, bool by_sweeps,
                        const Lcp& multipliers) {
  constexpr int kOuter = 2000, kSweeps = 10;
  const int max = settings.max_iterations > 0 ? settings.max_iterations : by_sweeps ? 20000 : kOuter;
  Lcp lcp = faceted.generator_form();
  const VectorXd q = lcp.q;
  VectorXd gamma = VectorXd::Zero(q.size());
  LcpSolution best{.x = gamma, .error = natural_error(multipliers, faceted.multipliers_of(gamma))};
  while (best.iterations < max && best.error > settings.tolerance && best.status != LcpStatus::ray) {
    lcp.q = q + faceted.slip_shift(faceted.impulses_of_generators(gamma));
    const LcpSolution next = by_sweeps ? solve_pgs(lcp, {0.1 * settings.tolerance, kSweeps}, gamma)
                                       : solve_qp(lcp, {0.1 * settings.tolerance, 0}, gamma);
    gamma = next.x;
    best.iterations += std::max(1, next.iterations);
    if (next.status == LcpStatus::ray) best.status = next.status;
    const double error = natural_error(multipliers, faceted.multipliers_of(gamma));
    if (error >= best.error) continue;
    best.error = error;
    best.x = gamma;
  }
  return best;
}

}  // namespace

LocalSolution solve_faceted(const LocalProblem& problem, const LocalSolveSettings& settings, Complementarity by) {
  BestSoFar best(problem, settings);
  const FacetedProblem faceted(problem, settings.target, settings.facets);
  const bool by_generators = by == Complementarity::pgs || by == Complementarity::qp;
  const Eigen::Index unknowns = by_generators ? faceted.generator_count() : faceted.multiplier_count();
  LocalSolution& solution = best.best;
  solution.facets = settings.facets;
  if (unknowns > most_unknowns(by)) {
    solution.refusal = too_large(settings.solver, unknowns, most_unknowns(by));
    return solution;
  }
  if (by == Complementarity::qp && !faceted.is_symmetric()) {
    solution.refusal = "qp refuses a matrix W that is not symmetric; take lemke or fb_newton";
    return solution;
  }
  const Lcp multipliers = faceted.multiplier_form();
  const LcpSettings inner{settings.tolerance, settings.max_iterations};
  const LcpSolution found = by_generators ? follow_slip(faceted, settings, by == Complementarity::pgs, multipliers)
                            : by == Complementarity::fb_newton ? solve_fb_newton(multipliers, inner)
                                                               : solve_lemke(multipliers, inner);
  const VectorXd r = by_generators ? faceted.impulses_of_generators(found.x) : faceted.impulses_of_multipliers(found.x);
  best.offer(faceted.scaled().impulses(r), found.iterations);
  solution.r = faceted.scaled().impulses(r);  // the method's own, also where rounder ones would have a lower error
  solution.error = siconos_error(problem, solution.r, settings.target);
  solution.iterations = found.iterations;
  solution.lcp_error = found.error;
  return solution;
}

}  // namespace gonogo::sim
