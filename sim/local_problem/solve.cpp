#include "sim/local_problem/solve.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "sim/local_problem/body_form.h"
#include "sim/local_problem/methods.h"
#include "sim/local_problem/one_contact.h"

namespace gonogo::sim {

const std::vector<std::string>& solver_names() {
  static const std::vector<std::string> names = {
      "nsgs",        "apgd",     "ppa",         "pdip",         "admm",     "lemke",  "pgs",
      "fb_newton",   "qp",       "jacobi",      "gauss_seidel", "nesterov", "minres", "pdip_spike",
      "pdip_krylov", "anderson", "pdip_bodies", "pdip_blocks",  "pdip_tt"};
  return names;
}

LocalSolver local_solver(const std::string& name) {
  const auto& names = solver_names();
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return LocalSolver(at - names.begin());
  std::string all;
  for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
  throw InputError("solver \"" + name + "\" is unknown; possible are " + all);
}

const char* solver_name(LocalSolver solver) { return solver_names()[std::size_t(solver)].c_str(); }

double claimed_error(const LocalSolution& solution) {
  if (!solution.refusal.empty()) return std::numeric_limits<double>::infinity();
  return solution.facets > 0 ? solution.lcp_error : solution.error;
}

bool takes_start(LocalSolver solver) {
  return solver == LocalSolver::nsgs || solver == LocalSolver::apgd || solver == LocalSolver::anderson;
}

std::vector<double> diagonal_weight(const LocalProblem& problem) {
  const int d = problem.dimension;
  std::vector<double> weight(problem.q.size());
  for (Index i = 0; i < problem.contact_count(); ++i) {
    const double* const block = problem.diagonal_block(i);
    double* const w = weight.data() + std::size_t(i) * d;
    w[0] = block[0];
    for (int k = 0; k < problem.disc_count(); ++k) {
      const FrictionDisc disc = problem.disc(k);
      double trace = 0;
      for (int a = disc.first; a < disc.first + disc.size; ++a) trace += block[a * d + a];
      for (int a = disc.first; a < disc.first + disc.size; ++a) w[a] = trace > 0 ? trace / disc.size : block[0];
    }
  }
  return weight;
}

void sweep(const LocalProblem& problem, Target target, std::vector<double>& r) {
  const int d = problem.dimension;
  ContactVelocities velocities(problem, r);
  double b[5], before[5];
  for (Index i = 0; i < problem.contact_count(); ++i) {
    double* const ri = r.data() + std::size_t(i) * d;
    const double* const block = problem.diagonal_block(i);
    velocities.at(i, b);
    std::copy_n(ri, d, before);
    for (int row = 0; row < d; ++row)
      for (int column = 0; column < d; ++column) b[row] -= block[row * d + column] * ri[column];
    solve_one_contact(problem, i, target, block, b, ri);
    velocities.changed(i, before);
  }
}

LocalSolution solve_nsgs(const LocalProblem& problem, const LocalSolveSettings& settings) {
  constexpr int kCheckEvery = 10;  // sweeps; an error costs as much as a sweep
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 20000;
  BestSoFar best(problem, settings);
  std::vector<double> r = best.best.r;
  int k = 0;
  while (k < max && best.best.error > settings.tolerance) {
    sweep(problem, settings.target, r);
    if (++k % kCheckEvery == 0 || k == max) best.offer(r, k);
  }
  best.best.iterations = k;
  return best.best;
}

namespace {

bool is_for_ccp_alone(LocalSolver solver) {
  switch (solver) {
    case LocalSolver::jacobi:
    case LocalSolver::gauss_seidel:
    case LocalSolver::nesterov:
    case LocalSolver::minres:
    case LocalSolver::anderson:
    case LocalSolver::pdip_blocks:
    case LocalSolver::pdip_tt:
      return true;
    default:
      return false;
  }
}

/// Whether the solver needs no more of W than products and diagonal blocks, or makes what it needs from the bodies.
bool is_without_matrix(LocalSolver solver, Target target) {
  switch (solver) {
    case LocalSolver::nsgs:
    case LocalSolver::apgd:
    case LocalSolver::anderson:
    case LocalSolver::jacobi:
    case LocalSolver::gauss_seidel:
    case LocalSolver::nesterov:
    case LocalSolver::pdip_bodies:
      return true;
    case LocalSolver::pdip:
      return target == Target::ccp;
    default:
      return false;
  }
}

void check(const LocalProblem& problem, const LocalSolveSettings& settings) {
  if (settings.facets < 4 || settings.facets > 256 || settings.facets % 2 != 0)
    throw InputError("facets = " + std::to_string(settings.facets) + "; an even number from 4 to 256 is needed");
  if (!(settings.omega >= 0 && settings.omega < 2) || !(settings.lambda > 0 && settings.lambda <= 1))
    throw InputError("omega = " + number_text(settings.omega) + " and lambda = " + number_text(settings.lambda) +
                     "; 0 <= omega < 2 and 0 < lambda <= 1 are needed");
  if (settings.start.empty()) return;
  if (!takes_start(settings.solver))
    throw InputError(std::string(solver_name(settings.solver)) + " takes no start; nsgs, apgd and anderson do");
  if (settings.start.size() != problem.q.size())
    throw InputError("start has " + std::to_string(settings.start.size()) + " impulses; " +
                     std::to_string(problem.q.size()) + " are needed");
}

LocalSolution refused(const LocalProblem& problem, const LocalSolveSettings& settings, const std::string& why) {
  LocalSolution none;
  none.r.assign(problem.q.size(), 0.0);
  none.error = siconos_error(problem, none.r, settings.target);
  none.refusal = solver_name(settings.solver) + why;
  return none;
}

}  // namespace

LocalSolution solve(const LocalProblem& problem, const LocalSolveSettings& settings) {
  check(problem, settings);
  if (settings.target == Target::coulomb && is_for_ccp_alone(settings.solver))
    return refused(problem, settings, " refuses coulomb; it solves the convex relaxation, ccp");
  if (settings.solver == LocalSolver::pdip_bodies && !problem.bodies)
    return refused(problem, settings, " refuses a problem whose bodies are not known; take a step of a scene, or pdip");
  if (!problem.is_whole && !is_without_matrix(settings.solver, settings.target))
    return refused(problem, settings,
                   " refuses a problem without its matrix W; take fewer bodies, or apgd, nsgs, anderson, pdip_bodies, "
                   "or pdip for ccp");
  switch (settings.solver) {
    case LocalSolver::nsgs:
      return solve_nsgs(problem, settings);
    case LocalSolver::anderson:
      return solve_anderson(problem, settings);
    case LocalSolver::apgd:
      return solve_apgd(problem, settings);
    case LocalSolver::ppa:
      return solve_ppa(problem, settings);
    case LocalSolver::pdip:
    case LocalSolver::pdip_spike:
    case LocalSolver::pdip_krylov:
    case LocalSolver::pdip_bodies:
    case LocalSolver::pdip_blocks:
    case LocalSolver::pdip_tt:
      return solve_pdip(problem, settings);
    case LocalSolver::admm:
      return solve_admm(problem, settings);
    case LocalSolver::jacobi:
    case LocalSolver::gauss_seidel:
      return solve_fixed_point(problem, settings);
    case LocalSolver::nesterov:
      return solve_nesterov(problem, settings);
    case LocalSolver::minres:
      return solve_minres(problem, settings);
    default:
      return solve_faceted(problem, settings);
  }
}

}  // namespace gonogo::sim
