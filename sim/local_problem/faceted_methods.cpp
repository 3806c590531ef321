// The LCP family on the polygons of faceted.h: lemke and fb_newton on the form with multipliers; pgs and qp on the one
// with generators, where `coulomb` is a sequence of convex programs.
#include "sim/local_problem/faceted.h"
#include "sim/local_problem/methods.h"

namespace gonogo::sim {
namespace {

using Eigen::VectorXd;

std::string too_large(LocalSolver solver, Eigen::Index unknowns, Eigen::Index most) {
  return std::string(solver_name(solver)) + " refuses " + std::to_string(unknowns) + " unknowns, more than " +
         std::to_string(most) + "; take fewer facets, pgs, or a solver of the round cone";
}

/// Most unknowns: lemke and qp keep dense matrices and need up to as many pivots; fb_newton factorises a matrix with
/// dense blocks of a contact's facets.
Eigen::Index most_unknowns(LocalSolver solver) {
  switch (solver) {
    case LocalSolver::lemke:
      return 2000;
    case LocalSolver::qp:
      return 4000;
    case LocalSolver::fb_newton:
      return 10000;
    default:
      return 200000;
  }
}

/// Convex programs with the slip's share in the normal velocities, until they agree.
LcpSolution follow_slip(const FacetedProblem& faceted, const LocalSolveSettings& settings, const Lcp& multipliers) {
  constexpr int kOuter = 2000, kSweeps = 10;
  const bool by_sweeps = settings.solver == LocalSolver::pgs;
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

LocalSolution solve_faceted(const LocalProblem& problem, const LocalSolveSettings& settings) {
  BestSoFar best(problem, settings);
  const FacetedProblem faceted(problem, settings.target, settings.facets);
  const bool by_generators = settings.solver == LocalSolver::pgs || settings.solver == LocalSolver::qp;
  const Eigen::Index unknowns = by_generators ? faceted.generator_count() : faceted.multiplier_count();
  LocalSolution& solution = best.best;
  solution.facets = settings.facets;
  if (unknowns > most_unknowns(settings.solver)) {
    solution.refusal = too_large(settings.solver, unknowns, most_unknowns(settings.solver));
    return solution;
  }
  if (settings.solver == LocalSolver::qp && !faceted.is_symmetric()) {
    solution.refusal = "qp refuses a matrix W that is not symmetric; take lemke or fb_newton";
    return solution;
  }
  const Lcp multipliers = faceted.multiplier_form();
  const LcpSettings inner{settings.tolerance, settings.max_iterations};
  const LcpSolution found = by_generators                               ? follow_slip(faceted, settings, multipliers)
                            : settings.solver == LocalSolver::fb_newton ? solve_fb_newton(multipliers, inner)
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
