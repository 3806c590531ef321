// Trees whose bodies also close loops (RBDA chapter 8): K dv = k - 2 a c' - a^2 c with the loops' errors c.
#pragma once
#include "vehicle/multibody/dynamics.h"

namespace gonogo::vehicle::multibody {

/// Holds a point of one body to a point of another: together (spherical), or at a distance.
struct Loop {
  int first = 0, second = 0;
  Vector3 first_point = Vector3::Zero(), second_point = Vector3::Zero();  // in the bodies' frames [m]
  double length = 0;                                                      // 0: spherical; distance of the points [m]
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

/// Forward dynamics with loops, from the mass matrix; equations that repeat each other are allowed. `stabilisation` a
/// [1/s] pulls loops closed that have drifted (Baumgarte 1972).
LoopMotion forward_with_loops(const Tree& tree, const std::vector<Loop>& loops, const VectorX& q, const VectorX& v,
                              const VectorX& tau, const Vector3& gravity, const std::vector<Vector6>& external = {},
                              double stabilisation = 0);

/// Positions near q that close the loops, by Newton steps of least length; `held` velocities do not take part (empty:
/// all do). Returns the largest remaining error [m] and leaves q at the best found.
double close_loops(const Tree& tree, const std::vector<Loop>& loops, VectorX& q, const std::vector<int>& held = {});

}  // namespace gonogo::vehicle::multibody
