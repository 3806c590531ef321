// Spatial vectors and Plücker transforms (Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, "RBDA", chapter
// 2). A motion vector is (angular; linear velocity of the frame's origin), a force vector (moment about the origin;
// force).
#pragma once
#include <Eigen/Dense>

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

}  // namespace gonogo::vehicle::multibody
