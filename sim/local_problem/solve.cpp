#include "sim/local_problem/solve.h"

#include "base/error.h"
#include "sim/local_problem/methods.h"
#include "sim/local_problem/one_contact.h"

namespace gonogo::sim {

LocalSolver local_solver(const std::string& name) {
  for (const LocalSolver s :
       {LocalSolver::nsgs, LocalSolver::apgd, LocalSolver::ppa, LocalSolver::pdip, LocalSolver::admm})
    if (name == solver_name(s)) return s;
  throw InputError("solver \"" + name + "\" is unknown; nsgs, apgd, ppa, pdip and admm are possible");
}

const char* solver_name(LocalSolver solver) {
  switch (solver) {
    case LocalSolver::nsgs:
      return "nsgs";
    case LocalSolver::apgd:
      return "apgd";
    case LocalSolver::pdip:
      return "pdip";
    case LocalSolver::admm:
      return "admm";
    default:
      return "ppa";
  }
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
  double b[5];
  for (Index i = 0; i < problem.contact_count(); ++i) {
    double* const ri = r.data() + std::size_t(i) * d;
    const double* const block = problem.diagonal_block(i);
    contact_velocity(problem, r, i, b);
    for (int row = 0; row < d; ++row)
      for (int column = 0; column < d; ++column) b[row] -= block[row * d + column] * ri[column];
    solve_one_contact(problem, i, target, block, b, ri);
  }
}

LocalSolution solve_nsgs(const LocalProblem& problem, const LocalSolveSettings& settings) {
  constexpr int kCheckEvery = 10;  // sweeps; an error costs as much as a sweep
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 20000;
  BestSoFar best(problem, settings.target);
  std::vector<double> r = best.best.r;
  int k = 0;
  while (k < max && best.best.error > settings.tolerance) {
    sweep(problem, settings.target, r);
    if (++k % kCheckEvery == 0 || k == max) best.offer(r);
  }
  best.best.iterations = k;
  return best.best;
}

LocalSolution solve(const LocalProblem& problem, const LocalSolveSettings& settings) {
  switch (settings.solver) {
    case LocalSolver::nsgs:
      return solve_nsgs(problem, settings);
    case LocalSolver::apgd:
      return solve_apgd(problem, settings);
    case LocalSolver::pdip:
      return solve_pdip(problem, settings);
    case LocalSolver::admm:
      return solve_admm(problem, settings);
    default:
      return solve_ppa(problem, settings);
  }
}

}  // namespace gonogo::sim
