// Accurate solvers of LocalProblem, in double precision on the host: the reference of the engine's own solvers.
//
//   nsgs  block Gauss-Seidel: each contact is solved exactly with the others held (Jean & Moreau; one_contact.h)
//   apgd  accelerated projected gradients with restart (Mazhar et al. 2015) on the convex program. For `coulomb` an
//         outer iteration shifts the normal velocities by De Saxce's term (Cadoux 2009).
//   ppa   proximal points around a semismooth Newton method. (W + alpha D) r + q - alpha D r_k is solved for r_{k+1} on
//         the function of Alart & Curnier (1991) with sparse LU; alpha falls as long as Newton converges. The most
//         accurate and most expensive method: it reaches 1e-8 where the others stall.
//   pdip  primal-dual interior point (pdip.cpp): 10 to 40 sparse factorisations, whatever the number of contacts; ends
//         like ppa where rounding stops it
//   admm  alternating directions with residual balancing (admm.cpp): one sparse factorisation for many iterations
#pragma once
#include <string>

#include "sim/local_problem/residual.h"

namespace gonogo::sim {

enum class LocalSolver { nsgs, apgd, ppa, pdip, admm };

struct LocalSolveSettings {
  LocalSolver solver = LocalSolver::ppa;
  Target target = Target::coulomb;
  double tolerance = 1e-8;  // of siconos_error for the target
  int max_iterations = 0;   // 0: the solver's own; sweeps, gradient steps or Newton steps
};

struct LocalSolution {
  std::vector<double> r;  // the best impulses found
  double error = 0;       // siconos_error for the target; may exceed the tolerance when the iterations ran out
  int iterations = 0;     // of the solver's own kind
};

LocalSolution solve(const LocalProblem& problem, const LocalSolveSettings& settings);

/// "nsgs", "apgd", "ppa", "pdip", "admm". Throws InputError naming all of them for another word.
LocalSolver local_solver(const std::string& name);
const char* solver_name(LocalSolver solver);

}  // namespace gonogo::sim
