// Accurate solvers of LocalProblem, in double precision on the host: the reference of the engine's own solvers.
//
//   nsgs  block Gauss-Seidel: each contact is solved exactly with the others held (Jean & Moreau; one_contact.h)
//   apgd  accelerated projected gradients with restart (Mazhar et al. 2015) on the convex program. For `coulomb` an
//         outer iteration shifts the normal velocities by De Saxce's term (Cadoux 2009).
//   ppa   proximal points around a semismooth Newton method. (W + alpha D) r + q - alpha D r_k is solved for r_{k+1} on
//         the function of Alart & Curnier (1991) with sparse LU; alpha falls as long as Newton converges. The most
//         accurate and most expensive method: it reaches 1e-8 where the others stall.
//   pdip  primal-dual interior point: 10 to 40 sparse factorisations, whatever the number of contacts; ends
//         like ppa where rounding stops it
//   admm  alternating directions with residual balancing: one sparse factorisation for many iterations
//
//   lemke, pgs, fb_newton, qp: linear complementarity with a polygon in each friction disc (faceted.h, lcp.h).
//         Their error to the round cone falls with the number of facets, to about 3 / facets where contacts slide.
//
//   pdip_spike, pdip_krylov: pdip with BiCGStab in place of factorisations, preconditioned by truncated SPIKE on 96
//         off-diagonals (banded/spike.h), and not preconditioned
//   pdip_bodies: pdip on matrices over bodies in place of contacts, for problems with a BodyForm
//   pdip_blocks, pdip_tt: pdip with conjugate gradients on blocks scaled to 1, and preconditioned by an inverse as a
//         tensor train; for `ccp` alone
//   anderson: nsgs, extrapolated from its last sweeps; for `ccp` alone
//   jacobi, gauss_seidel, nesterov, minres: for `ccp` alone; the first three as published
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "sim/local_problem/problem.h"

namespace gonogo::sim {

struct LocalMethod;
/// A row of the table in solve.cpp: local_solver("ppa").
using LocalSolver = const LocalMethod*;

/// Throws InputError naming all of them for another word.
LocalSolver local_solver(const std::string& name);
const char* solver_name(LocalSolver solver);
/// All names, in the order of the table.
const std::vector<std::string>& solver_names();

struct LocalSolveSettings {
  LocalSolver solver = local_solver("ppa");
  Target target = Target::coulomb;
  double tolerance = 1e-8;       // of siconos_error for the target; of lcp_error for the LCP family
  int max_iterations = 0;        // 0: the solver's own; sweeps, gradient steps, Newton steps or pivots
  int facets = 8;                // of the LCP family, per friction disc in space: even, 4 .. 256
  double omega = 0, lambda = 1;  // relaxation and smoothing of jacobi and gauss_seidel; omega 0: 0.2 and 1
  bool keeps_trace = false;
  std::vector<double> start = {};  // impulses to begin with; empty: 0. Only for solvers that take one
};

struct TracePoint {
  int iteration;
  double seconds, error;  // processor time of all threads since the start; lowest siconos_error so far
};

struct LocalSolution {
  std::vector<double> r;          // the best impulses found
  double error = 0;               // siconos_error for the target; may exceed the tolerance when the iterations ran out
  int iterations = 0;             // of the solver's own kind
  int facets = 0;                 // of the LCP family; otherwise 0
  double lcp_error = 0;           // natural residual of the problem with facets, relative to its q; `error` is what is
                                  // left to the round cone
  std::string refusal;            // one sentence, why the solver does not take the problem; r is 0 then. Empty: it does
  LinearWork linear;              // of pdip_spike, pdip_krylov and minres (its products with W alone)
  std::vector<TracePoint> trace;  // with keeps_trace
};

/// What the solver claims to have solved: lcp_error for the LCP family, otherwise error; infinite for a refusal.
double claimed_error(const LocalSolution& solution);

/// Whether the solver can begin with LocalSolveSettings::start.
bool takes_start(LocalSolver solver);

/// Throws InputError for a number of facets out of range, and for a start that the solver does not take or whose length
/// is not that of q. Throws Cancelled when the user asked to stop.
LocalSolution solve(const LocalProblem& problem, const LocalSolveSettings& settings);

}  // namespace gonogo::sim
