// Assemblies of bodies by their equations of motion at their handles, a = Phi f + b: the joints that connect them to
// the rest. Two assemblies are joined at one joint, whose force is eliminated; on the way back the joint's force and
// acceleration follow from the forces at the handles of what it joined. All vectors are in world coordinates about the
// world's origin, so that all handles of a rigid body have the same acceleration. Inside vehicle/multibody.
#pragma once
#include "vehicle/multibody/tree.h"

namespace gonogo::vehicle::multibody {

using Subspace = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Ends of joints: handle 2 i is joint i on body i, handle 2 i + 1 on its parent.
struct Assembled {
  std::vector<int> handle;
  MatrixX phi;  // 6 x 6 block for every pair of handles
  VectorX b;

  /// Place of a handle; the number of handles when it is not there.
  int index(int h) const;
};

/// A joint that two assemblies were joined at, for the way back.
struct Joined {
  int joint = 0;
  Assembled child, parent;  // before joining
  MatrixX v = {};           // W - W S D S^T W
  Subspace ws = {};         // W S
  MatrixX d = {};           // (S^T W S)^-1
};

/// Bodies in world coordinates.
struct Bodies {
  const Tree& tree;
  std::vector<Subspace> s{};        // S in world coordinates
  std::vector<Vector6> coriolis{};  // v x S qd
  std::vector<VectorX> tau{};
  std::vector<Matrix6> inverse_inertia{};
  std::vector<Vector6> free{};  // acceleration without handle forces, gravity taken off
};

/// Arguments as of forward_by_articulated_bodies().
Bodies bodies_of(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau, const Vector3& gravity,
                 const std::vector<Vector6>& external);

/// One body and its joints.
Assembled single(const Bodies& w, int body);

/// The world, which does not move, with a handle for every body that is joined to it.
Assembled ground(const Tree& tree);

/// Joins child and parent at a joint: its force f on the child (and -f on the parent) keeps a_child - a_parent = S qdd
/// + c with S^T f = tau. Fills the way back.
Assembled join(const Bodies& w, Joined& j);

/// The way back: from the forces at the handles of what was joined, the joint's own force and acceleration.
void open(const Bodies& w, const Joined& j, std::vector<Vector6>& force, VectorX& dv);

}  // namespace gonogo::vehicle::multibody
