// The convex relaxation of a contact problem on polygons as a quadratic program with bounds alone, the form that
// optimisers and annealers take:
//
//   min 1/2 x M x + q x,  x >= 0;   impulses r = G x with the generators G of the polyhedral cone (faceted.h)
//
// Impulses and velocities are scaled so that numbers are near 1.
#pragma once
#include "sim/local_problem/problem.h"

namespace gonogo::sim {

struct BoundedProgram {
  Index unknowns = 0;
  std::vector<double> m, q;          // [unknowns x unknowns] row major, symmetric; [unknowns]
  std::vector<double> generators{};  // [rows of the problem x unknowns] row major, in the units of the problem
  std::vector<double> minimiser{};   // exact, by active sets [unknowns]
  double minimum = 0;                // of the objective

  double objective(const std::vector<double>& x) const;
  std::vector<double> impulses(const std::vector<double>& x) const;
};

/// Throws InputError for a problem with W not symmetric, more than 400 unknowns, or no solution.
BoundedProgram bounded_program(const LocalProblem& problem, int facets);

}  // namespace gonogo::sim
