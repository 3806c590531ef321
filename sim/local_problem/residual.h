// Error of impulses r as a solution of a LocalProblem; the measure of every solver here.
#pragma once
#include "sim/local_problem/problem.h"
#include "sim/state/target.h"

namespace gonogo::sim {

/// Nearest point of K, in the plain metric, for one contact: p[dimension] in and out.
///   min (n - p_n)^2 + sum_d (|t_d| - |p_d|)^2,  n >= 0, |t_d| <= c_d n
void project_onto_cone(const LocalProblem& problem, Index contact, double* p);

/// De Saxce's term sum_d c_d |u_d|: what `coulomb` adds to the normal velocity, so that u_n = 0 in sliding.
double de_saxce_term(const LocalProblem& problem, Index contact, const double* u);

/// | r - P_K(r - u^) | / max(|q|, |r|, |u|) with u = W r + q and u^ = u + de_saxce_term e_n for `coulomb`, u^ = u for
/// `ccp`; Euclidean norms over all contacts, as in fc3d_compute_error of Siconos. 0 when q, r and u are all 0.
double siconos_error(const LocalProblem& problem, const std::vector<double>& r, Target target = Target::coulomb);
/// With u = W r + q given.
double siconos_error(const LocalProblem& problem, const std::vector<double>& r, const std::vector<double>& u,
                     Target target);

}  // namespace gonogo::sim
