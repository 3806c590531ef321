// Dynamics of a tree: M(q) dv/dt + h(q, v) = tau + sum J^T f. `gravity` is in the world frame [m/s^2]. `external` is
// empty or has one spatial force per body, in the body's frame. RBDA: see spatial.h.
#pragma once
#include "vehicle/multibody/tree.h"

namespace gonogo::vehicle::multibody {

/// Joint forces tau for the accelerations `dv`. Recursive Newton-Euler (Luh, Walker & Paul 1980; RBDA table 5.1).
VectorX inverse_dynamics(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& dv,
                         const Vector3& gravity, const std::vector<Vector6>& external = {});

/// Mass matrix, column by column: inverse dynamics of unit accelerations (Walker & Orin 1982, method 1; RBDA 6.1).
MatrixX mass_matrix_by_unit_vectors(const Tree& tree, const VectorX& q);

/// Mass matrix by composite rigid bodies (Walker & Orin 1982, method 3; RBDA table 6.2).
MatrixX mass_matrix_by_composites(const Tree& tree, const VectorX& q);

/// Accelerations by articulated bodies (Featherstone 1983; RBDA table 7.1). Linear in the number of bodies.
VectorX forward_by_articulated_bodies(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau,
                                      const Vector3& gravity, const std::vector<Vector6>& external = {});

/// Accelerations by divide and conquer (Featherstone, "A Divide-and-Conquer Articulated-Body Algorithm for Parallel
/// O(log(n)) Calculation of Rigid-Body Dynamics", Int. J. Robotics Research 18(9), 1999, parts 1 and 2).
VectorX forward_by_divide_and_conquer(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau,
                                      const Vector3& gravity, const std::vector<Vector6>& external = {});

/// Accelerations by assembly and disassembly (Yamane & Nakamura, "Comparative Study on Serial and Parallel Forward
/// Dynamics Algorithms for Kinematic Chains", Int. J. Robotics Research 28(5), 2009): joints are closed one by one and
/// opened in reverse. `order`: all joints, in any order; empty: from the tips to the root, linear in the number of
/// bodies of a chain. Throws InputError for an order that leaves joints out or repeats them.
VectorX forward_by_assembly(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau,
                            const Vector3& gravity, const std::vector<Vector6>& external = {},
                            const std::vector<int>& order = {});

// Trees with loop closures (RBDA chapter 8): K dv = k - 2 a c' - a^2 c, where c are the errors of the loops.

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
