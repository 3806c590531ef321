// Trees with loop closures (RBDA chapter 8): K dv = k - 2 a c' - a^2 c, where c are the errors of the loops.
#pragma once
#include "vehicle/multibody/dynamics.h"

namespace gonogo::vehicle::multibody {

/// Holds a point of one body at a point of another (spherical), or at a fixed distance from it.
struct Loop {
  int first = 0, second = 0;
  Vector3 first_point = Vector3::Zero(), second_point = Vector3::Zero();  // in the bodies' frames [m]
  double length = 0;                                                      // distance of the points [m]; 0: spherical
};

struct LoopEquations {
  MatrixX jacobian;  // K
  VectorX bias;      // k: K dv = bias keeps the loops closed
  VectorX error;     // [m]
};
LoopEquations loop_equations(const Tree& tree, const std::vector<Loop>& loops, const Kinematics& k, const VectorX& v);

struct LoopMotion {
  VectorX acceleration;  // dv
  VectorX force;         // of the loops, along their equations [N]
};

/// Forward dynamics with loops, by the mass matrix. Redundant equations are allowed. `stabilisation` is a [1/s], which
/// corrects the drift of loops (Baumgarte 1972).
LoopMotion forward_with_loops(const Tree& tree, const std::vector<Loop>& loops, const VectorX& q, const VectorX& v,
                              const VectorX& tau, const Vector3& gravity, const std::vector<Vector6>& external = {},
                              double stabilisation = 0);

/// Moves q to nearby positions that close the loops, by Newton steps of minimal length. `held` velocities do not
/// change. Returns the largest remaining error [m]; q is the best position found.
double close_loops(const Tree& tree, const std::vector<Loop>& loops, VectorX& q, const std::vector<int>& held = {});

}  // namespace gonogo::vehicle::multibody
