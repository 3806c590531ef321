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

}  // namespace gonogo::vehicle::multibody
