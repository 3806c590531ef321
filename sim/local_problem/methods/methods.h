// The methods behind solve(): the table in solve.cpp has a row for each.
#pragma once
#include <ctime>

#include "base/progress.h"
#include "sim/local_problem/algebra/newton_system.h"
#include "sim/local_problem/methods/solve.h"

namespace gonogo::sim {

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// A method as solve() calls it.
struct LocalMethod {
  enum class Matrix { needed, needed_for_coulomb, not_needed };  // else products and diagonal blocks serve, or bodies

  const char* name;
  LocalSolution (*solve)(const LocalProblem& problem, const LocalSolveSettings& settings);
  Matrix matrix = Matrix::needed;
  bool is_for_ccp_alone = false, takes_start = false, needs_bodies = false;
};

/// Keeps the best impulses offered, and the way there when the settings ask for it.
struct BestSoFar {
  const LocalProblem& problem;
  const LocalSolveSettings& settings;
  LocalSolution best;

  BestSoFar(const LocalProblem& p, const LocalSolveSettings& s) : problem(p), settings(s) {
    best.r = s.start.empty() ? std::vector<double>(p.q.size(), 0.0) : s.start;
    best.error = siconos_error(p, best.r, s.target);
    note(0);
  }

  /// Returns the error of r, found after `iteration` iterations. Throws Cancelled when the user asked to stop.
  double offer(const std::vector<double>& r, int iteration) { return offer(r, velocity(problem, r), iteration); }
  /// With u = W r + q given.
  double offer(const std::vector<double>& r, const std::vector<double>& u, int iteration) {
    stop_if_cancelled();
    const double error = siconos_error(problem, r, u, settings.target);
    if (error < best.error) {
      best.error = error;
      best.r = r;
    }
    note(iteration);
    return error;
  }

 private:
  void note(int iteration) {
    if (!settings.keeps_trace) return;
    best.trace.push_back({iteration, double(std::clock() - start) / CLOCKS_PER_SEC, best.error});
  }
  std::clock_t start = std::clock();
};

/// Diagonal of W, averaged over each disc: one value per normal and disc, in every row of the disc.
std::vector<double> diagonal_weight(const LocalProblem& problem);

/// One sweep over all contacts in their order.
void sweep(const LocalProblem& problem, Target target, std::vector<double>& r);

LocalSolution solve_nsgs(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_anderson(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_apgd(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_admm(const LocalProblem& problem, const LocalSolveSettings& settings);
/// With relaxation and smoothing, as published.
LocalSolution solve_jacobi(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_gauss_seidel(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_nesterov(const LocalProblem& problem, const LocalSolveSettings& settings);
LocalSolution solve_minres(const LocalProblem& problem, const LocalSolveSettings& settings);

LocalSolution solve_ppa(const LocalProblem& problem, const LocalSolveSettings& settings);
/// Lowers the error of `best` from its impulses by proximal points, at most `max` Newton steps; adds to its iterations.
void finish_by_proximal_points(const LocalProblem& problem, const LocalSolveSettings& settings, int max,
                               BestSoFar& best);

LocalSolution solve_pdip(const LocalProblem& problem, const LocalSolveSettings& settings, NewtonKind kind);

enum class Complementarity { lemke, pgs, fb_newton, qp };
/// On polygons in place of the friction discs.
LocalSolution solve_faceted(const LocalProblem& problem, const LocalSolveSettings& settings, Complementarity by);

}  // namespace gonogo::sim
