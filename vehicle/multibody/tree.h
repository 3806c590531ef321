// Spatial vectors and Plücker transforms (Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, "RBDA", chapter
// 2). A motion vector is (angular; linear velocity of the frame's origin), a force vector (moment about the origin;
// force).
#pragma once
#include <Eigen/Dense>
#include <vector>

namespace gonogo::vehicle::multibody {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using VectorX = Eigen::VectorXd;
using MatrixX = Eigen::MatrixXd;

inline Matrix3 skew(const Vector3& v) {
  Matrix3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// v x m, for motion vectors (RBDA 2.31).
inline Vector6 cross_motion(const Vector6& v, const Vector6& m) {
  const Vector3 w = v.head<3>(), l = v.tail<3>();
  Vector6 result;
  result << w.cross(m.head<3>()), l.cross(m.head<3>()) + w.cross(m.tail<3>());
  return result;
}

/// v x* f, for a motion and a force vector (RBDA 2.32).
inline Vector6 cross_force(const Vector6& v, const Vector6& f) {
  const Vector3 w = v.head<3>(), l = v.tail<3>();
  Vector6 result;
  result << w.cross(f.head<3>()) + l.cross(f.tail<3>()), w.cross(f.tail<3>());
  return result;
}

/// From frame A to frame B: E turns A's coordinates into B's, r is B's origin in A (RBDA table 2.2).
struct Transform {
  Matrix3 E = Matrix3::Identity();
  Vector3 r = Vector3::Zero();

  /// For motion vectors.
  Matrix6 motion() const {
    Matrix6 x;
    x << E, Matrix3::Zero(), -E * skew(r), E;
    return x;
  }
  /// First `first`, then this.
  Transform after(const Transform& first) const { return {E * first.E, first.r + first.E.transpose() * r}; }
  /// Coordinates in B of a point given in A.
  Vector3 point(const Vector3& p) const { return E * (p - r); }
  /// Coordinates in A of a point given in B.
  Vector3 point_back(const Vector3& p) const { return E.transpose() * p + r; }
};

/// Spatial inertia about the frame's origin from mass [kg], centre of mass [m] and rotational inertia about it [kg m^2]
/// (RBDA 2.63).
inline Matrix6 spatial_inertia(double mass, const Vector3& centre, const Matrix3& about_centre) {
  const Matrix3 c = skew(centre);
  Matrix6 inertia;
  inertia << about_centre + mass * c * c.transpose(), mass * c, mass * c.transpose(), mass * Matrix3::Identity();
  return inertia;
}

/// Force vector of a force [N] that acts at a point [m] of the frame.
inline Vector6 force_at(const Vector3& point, const Vector3& force) {
  Vector6 f;
  f << point.cross(force), force;
  return f;
}

// Rigid bodies joined to a tree: model, state, kinematics (RBDA chapter 4). Bodies are numbered so that a parent comes
// before its children; -1 is the world. World frame: x forward, y left, z up; SI units.

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
