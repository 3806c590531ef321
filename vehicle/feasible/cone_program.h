// Small convex cone programs: minimise c.x subject to A x = b and h - G x in K, where K is a product of half-lines and
// second-order cones {(t, v): |v| <= t}. Primal-dual interior-point method with Nesterov-Todd scaling and Mehrotra's
// corrector (Vandenberghe, "The CVXOPT linear and quadratic cone program solvers", 2010; Nesterov & Todd 1997).
// The program and its dual must have interior points. Then small residuals and a small gap prove the answer optimal.
#pragma once
#include <Eigen/Dense>
#include <vector>

namespace gonogo::vehicle {

struct ConeProgram {
  Eigen::VectorXd c;
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  Eigen::MatrixXd G;
  Eigen::VectorXd h;
  std::vector<int> cone;  // size of each cone, in the order of G's rows; 1: half-line
};

struct ConeAnswer {
  Eigen::VectorXd x{};     // primal
  Eigen::VectorXd s{};     // h - G x
  Eigen::VectorXd y{};     // of the equations
  Eigen::VectorXd z{};     // of the cones; A^T y + G^T z + c = 0
  double residual = 0;     // largest of |A x - b|, |G x + s - h|, |A^T y + G^T z + c|
  double gap = 0;          // s.z
  bool consistent = true;  // A x = b has a solution; otherwise x is empty
  bool solved = false;     // residual and gap below the tolerance times the size of x, z and of c.x
  int iterations = 0;
};

/// Redundant equations are dropped.
ConeAnswer solve(ConeProgram program, double tolerance = 1e-9);

}  // namespace gonogo::vehicle
