#include "sim/local_problem/methods/solve.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "sim/local_problem/methods/methods.h"
#include "sim/local_problem/one_contact.h"

namespace gonogo::sim {
namespace {

using W = LocalMethod::Matrix;

template <NewtonKind kind>
LocalSolution interior_point(const LocalProblem& problem, const LocalSolveSettings& settings) {
  return solve_pdip(problem, settings, kind);
}

template <Complementarity by>
LocalSolution faceted(const LocalProblem& problem, const LocalSolveSettings& settings) {
  return solve_faceted(problem, settings, by);
}

/// The methods, in the order in which users see them.
const std::vector<LocalMethod>& methods() {
  static const std::vector<LocalMethod> all = {
      {.name = "nsgs", .solve = solve_nsgs, .matrix = W::not_needed, .takes_start = true},
      {.name = "apgd", .solve = solve_apgd, .matrix = W::not_needed, .takes_start = true},
      {.name = "ppa", .solve = solve_ppa},
      {.name = "pdip", .solve = interior_point<NewtonKind::direct>, .matrix = W::needed_for_coulomb},
      {.name = "admm", .solve = solve_admm},
      {.name = "lemke", .solve = faceted<Complementarity::lemke>},
      {.name = "pgs", .solve = faceted<Complementarity::pgs>},
      {.name = "fb_newton", .solve = faceted<Complementarity::fb_newton>},
      {.name = "qp", .solve = faceted<Complementarity::qp>},
      {.name = "jacobi", .solve = solve_jacobi, .matrix = W::not_needed, .is_for_ccp_alone = true},
      {.name = "gauss_seidel", .solve = solve_gauss_seidel, .matrix = W::not_needed, .is_for_ccp_alone = true},
      {.name = "nesterov", .solve = solve_nesterov, .matrix = W::not_needed, .is_for_ccp_alone = true},
      {.name = "minres", .solve = solve_minres, .is_for_ccp_alone = true},
      {.name = "pdip_spike", .solve = interior_point<NewtonKind::spike>},
      {.name = "pdip_krylov", .solve = interior_point<NewtonKind::krylov>},
      {.name = "anderson",
       .solve = solve_anderson,
       .matrix = W::not_needed,
       .is_for_ccp_alone = true,
       .takes_start = true},
      {.name = "pdip_bodies",
       .solve = interior_point<NewtonKind::bodies>,
       .matrix = W::not_needed,
       .needs_bodies = true},
      {.name = "pdip_blocks", .solve = interior_point<NewtonKind::blocks>, .is_for_ccp_alone = true},
      {.name = "pdip_tt", .solve = interior_point<NewtonKind::tensor_train>, .is_for_ccp_alone = true}};
  return all;
}

}  // namespace

const std::vector<std::string>& solver_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const LocalMethod& method : methods()) all.push_back(method.name);
    return all;
  }();
  return names;
}

LocalSolver local_solver(const std::string& name) {
  std::string all;
  for (const LocalMethod& method : methods()) {
    if (method.name == name) return &method;
    all += std::string(all.empty() ? "" : ", ") + method.name;
  }
  throw InputError("solver \"" + name + "\" is unknown; possible are " + all);
}

const char* solver_name(LocalSolver solver) { return solver->name; }

double claimed_error(const LocalSolution& solution) {
  if (!solution.refusal.empty()) return std::numeric_limits<double>::infinity();
  return solution.facets > 0 ? solution.lcp_error : solution.error;
}

bool takes_start(LocalSolver solver) { return solver->takes_start; }

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
  const LocalMethod& method = *settings.solver;
  const bool is_coulomb = settings.target == Target::coulomb;
  if (is_coulomb && method.is_for_ccp_alone)
    return refused(problem, settings, " refuses coulomb; it solves the convex relaxation, ccp");
  if (method.needs_bodies && !problem.bodies)
    return refused(problem, settings, " refuses a problem whose bodies are not known; take a step of a scene, or pdip");
  if (!problem.is_whole && (method.matrix == W::needed || (is_coulomb && method.matrix == W::needed_for_coulomb)))
    return refused(problem, settings,
                   " refuses a problem without its matrix W; take fewer bodies, or apgd, nsgs, anderson, pdip_bodies, "
                   "or pdip for ccp");
  return method.solve(problem, settings);
}

}  // namespace gonogo::sim
