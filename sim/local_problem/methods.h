// The methods behind solve(). Inside sim/local_problem.
#pragma once
#include "sim/local_problem/solve.h"

namespace gonogo::sim {

/// Keeps the best impulses offered.
struct BestSoFar {
  const LocalProblem& problem;
  Target target;
  LocalSolution best;

  BestSoFar(const LocalProblem& p, Target t) : problem(p), target(t) {
    best.r.assign(p.q.size(), 0.0);
    best.error = siconos_error(p, best.r, t);
  }

  /// Returns the error of r.
  double offer(const std::vector<double>& r) {
    const double error = siconos_error(problem, r, target);
    if (error < best.error) {
      best.error = error;
      best.r = r;
    }
    return error;
  }
};

/// Diagonal of W, averaged over each disc: one value per normal and disc, in every row of the disc.
std::vector<double> diagonal_weight(const LocalProblem& problem);

/// One sweep over all contacts in their order.
void sweep(const LocalProblem& problem, Target target, std::vector<double>& r);

LocalSolution solve_nsgs(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_apgd(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_ppa(const LocalProblem& problem, const LocalSolveSettings& settings);

/// Lowers the error of `best` from its impulses by proximal points, at most `max` Newton steps; adds to its iterations.
void finish_by_proximal_points(const LocalProblem& problem, const LocalSolveSettings& settings, int max,
                               BestSoFar& best);

LocalSolution solve_pdip(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_admm(const LocalProblem& problem, const LocalSolveSettings& settings);

}  // namespace gonogo::sim
