// Exact solution of the problem of a single contact, u = A r + b with the contact's own block A of W.
//
// Coulomb:
//   b_n >= 0                      open:   r = 0
//   -A^-1 b in K                  stick:  u = 0
//   otherwise                     slide:  u_n = 0, u_t = -lambda r_t with |r_t| = mu r_n
// With u_n = 0 eliminated, r_t = -(S + lambda)^-1 (b_t - A_tn b_n / A_nn), S = A_tt - A_tn A_nt / A_nn, and
// r_n = -(b_n + A_nt r_t) / A_nn. The excess |r_t| - mu r_n is continuous in lambda >= 0, positive at 0 when the
// contact slides, and tends to mu b_n / A_nn < 0: a bracketed root, the one with lambda >= 0 of the quartic of Bonnefon
// & Daviet (2011). With rolling a second disc has a lambda of its own; then friction is first solved for a given bound
// (c_d n, convex: its excess falls with each lambda) and u_n(n) = 0 by a bracketed root over n: n u_n >= r A r - n b_n
// holds because friction does no work on the contact, so that u_n > 0 for large n.
//
// CCP: Newton on the natural map, started by projected gradients where it does not converge at once.
#pragma once
#include <Eigen/Dense>

#include "sim/local_problem/problem.h"

namespace gonogo::sim {

/// Impulse r[dimension] of `contact` (in: a guess) when the rest of the problem gives it the velocity b[dimension] at
/// r = 0; `a` is its block of W, row major, with a[0] > 0 and a positive semidefinite symmetric part.
void solve_one_contact(const LocalProblem& problem, Index contact, Target target, const double* a, const double* b,
                       double* r);

// Functions whose zero is the solution of one contact, and their derivatives, for Newton.

using ContactMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 5, 5>;
using ContactVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 5, 1>;

/// dF = by_u du + by_r dr.
struct ConeDerivative {
  ContactMatrix by_u, by_r;
};

/// F(r, u) into f[dimension]; returns whether the contact opens (then F = r). With `derivative` also its derivative.
/// `weight`: the inverse of the steps rho, one per normal and disc (the normal's alone for `ccp`).
///
/// coulomb: Alart & Curnier (1991),
///   F_n = r_n - max(0, y_n),  y_n = r_n - rho_n u_n
///   F_d = r_d - y_d min(1, c_d max(0, y_n) / |y_d|),  y_d = r_d - rho_d u_d
/// ccp: the natural map, F = r - P_K(y), y = r - rho_n u; P_K: projection onto the cone.
bool cone_function(const LocalProblem& problem, Index contact, Target target, const double* weight, const double* r,
                   const double* u, double* f, ConeDerivative* derivative);

}  // namespace gonogo::sim
