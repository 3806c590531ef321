// Rigid bodies joined to a tree: model, state, kinematics (RBDA chapter 4). Bodies are numbered so that a parent comes
// before its children; -1 is the world. World frame: x forward, y left, z up; SI units.
#pragma once
#include <vector>

#include "vehicle/multibody/spatial.h"

namespace gonogo::vehicle::multibody {

/// Positions and velocities of a joint, all in the child's frame:
///   floating   quaternion (w, x, y, z) child to parent, position of the child's origin in the parent; spatial velocity
///   spherical  quaternion (w, x, y, z) child to parent; angular velocity
///   revolute   angle about `axis` [rad]; its rate
///   prismatic  way along `axis` [m]; its rate
enum class JointType { floating, spherical, revolute, prismatic };

int position_count(JointType type);
int velocity_count(JointType type);

struct TreeBody {
  int parent = -1;
  JointType type = JointType::revolute;
  Vector3 axis = Vector3::UnitZ();        // unit
  Transform from_parent;                  // parent's frame to the joint's, which is the child's at zero position
  Matrix6 inertia = Matrix6::Identity();  // in the child's frame
  int first_position = 0, first_velocity = 0;
};

class Tree {
 public:
  /// Returns the body's number. Throws InputError for a parent that is not there and an inertia that is not positive.
  int add(TreeBody body);

  int body_count() const { return int(body_.size()); }
  int position_count() const { return positions_; }
  int velocity_count() const { return velocities_; }
  const TreeBody& body(int i) const { return body_[std::size_t(i)]; }
  /// Positions at which every joint is at zero.
  VectorX zero_position() const;

 private:
  std::vector<TreeBody> body_;
  int positions_ = 0, velocities_ = 0;
};

/// Motion subspace S of a joint, constant in the child's frame (RBDA table 4.1): 6 x velocity_count.
Eigen::Matrix<double, 6, Eigen::Dynamic> motion_subspace(const TreeBody& body);

/// From the parent's frame to the child's, for the positions q of the tree.
Transform joint_transform(const TreeBody& body, const VectorX& q);

/// Where bodies are and how they move; vectors in each body's own frame.
struct Kinematics {
  std::vector<Transform> from_parent, from_world;
  std::vector<Vector6> velocity;
};
Kinematics kinematics(const Tree& tree, const VectorX& q, const VectorX& v);

/// q after `step` seconds at velocity v, quaternions turned exactly and kept at unit length.
VectorX moved(const Tree& tree, const VectorX& q, const VectorX& v, double step);

/// World position [m] and velocity [m/s] of a point fixed in a body.
Vector3 point_position(const Kinematics& k, int body, const Vector3& point_B);
Vector3 point_velocity(const Kinematics& k, int body, const Vector3& point_B);
/// 3 x velocity_count: point_velocity = J v.
MatrixX point_jacobian(const Tree& tree, const Kinematics& k, int body, const Vector3& point_B);
/// Acceleration of the point when all joint accelerations are zero, without gravity [m/s^2].
Vector3 point_bias(const Tree& tree, const Kinematics& k, const VectorX& v, int body, const Vector3& point_B);

/// Kinetic energy, and potential energy in a field of gravity [J].
double kinetic_energy(const Tree& tree, const Kinematics& k);
double potential_energy(const Tree& tree, const Kinematics& k, const Vector3& gravity);

}  // namespace gonogo::vehicle::multibody
