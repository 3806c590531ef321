// Functions whose zero is the solution of one contact, and their derivatives, for Newton. Inside sim/local_problem.
#pragma once
#include <Eigen/Dense>

#include "sim/local_problem/residual.h"

namespace gonogo::sim {

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
