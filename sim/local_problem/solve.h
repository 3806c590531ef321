// Accurate solvers of LocalProblem, in double precision on the host: the reference of the engine's own solvers.
//
//   nsgs  block Gauss-Seidel: contact after contact solved exactly with the rest held (Jean & Moreau; one_contact.h)
//   apgd  accelerated projected gradients with restart (Mazhar et al. 2015) on the convex program; for `coulomb` its
//         normal velocities are shifted by De Saxce's term, which follows the solution from outside (Cadoux 2009)
//   ppa   proximal points around a semismooth Newton method: (W + alpha D) r + q - alpha D r_k is solved for r_{k+1} on
//         the function of Alart & Curnier (1991) with sparse LU; alpha falls as long as Newton converges. The most
//         accurate one: reaches 1e-8 where the others stall, at the price of factorisations.
#pragma once
#include <string>

#include "sim/local_problem/residual.h"

namespace gonogo::sim {

enum class LocalSolver { nsgs, apgd, ppa };

struct LocalSolveSettings {
  LocalSolver solver = LocalSolver::ppa;
  Target target = Target::coulomb;
  double tolerance = 1e-8;  // of siconos_error for the target
  int max_iterations = 0;   // 0: the solver's own; sweeps, gradient steps or Newton steps
};

struct LocalSolution {
  std::vector<double> r;  // impulses: the best met
  double error = 0;       // siconos_error for the target; may exceed the tolerance when the iterations ran out
  int iterations = 0;     // of the solver's own kind
};

LocalSolution solve(const LocalProblem& problem, const LocalSolveSettings& settings);

/// "nsgs", "apgd", "ppa". Throws InputError naming all of them for another word.
LocalSolver local_solver(const std::string& name);
const char* solver_name(LocalSolver solver);

}  // namespace gonogo::sim
