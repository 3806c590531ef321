#include "vehicle/multibody/tree.h"

#include <string>

#include "base/error.h"

namespace gonogo::vehicle::multibody {
namespace {

Eigen::Quaterniond quaternion(const VectorX& q, int first) {
  return Eigen::Quaterniond(q(first), q(first + 1), q(first + 2), q(first + 3)).normalized();
}

/// q after turning at constant angular velocity w in the child's frame: q exp(w step / 2).
void turn(VectorX& q, int first, const Vector3& w, double step) {
  const double angle = w.norm() * step;
  const Eigen::Quaterniond by =
      angle != 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, w.normalized())) : Eigen::Quaterniond::Identity();
  const Eigen::Quaterniond next = (quaternion(q, first) * by).normalized();
  q.segment<4>(first) << next.w(), next.x(), next.y(), next.z();
}

}  // namespace

int position_count(JointType type) { return type == JointType::floating ? 7 : type == JointType::spherical ? 4 : 1; }

int velocity_count(JointType type) { return type == JointType::floating ? 6 : type == JointType::spherical ? 3 : 1; }

int Tree::add(TreeBody body) {
  const std::string name = "body " + std::to_string(body_.size()) + " of the tree";
  if (body.parent < -1 || body.parent >= body_count()) throw InputError(name + ": its parent must come before it");
  const Eigen::LLT<Matrix6> factor(body.inertia);
  if (factor.info() != Eigen::Success) throw InputError(name + ": its mass and inertia must be positive");
  body.first_position = positions_;
  body.first_velocity = velocities_;
  positions_ += multibody::position_count(body.type);
  velocities_ += multibody::velocity_count(body.type);
  body_.push_back(body);
  return body_count() - 1;
}

VectorX Tree::zero_position() const {
  VectorX q = VectorX::Zero(positions_);
  for (const TreeBody& b : body_)
    if (b.type == JointType::floating || b.type == JointType::spherical) q(b.first_position) = 1;
  return q;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> motion_subspace(const TreeBody& body) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> s(6, velocity_count(body.type));
  s.setZero();
  if (body.type == JointType::floating) s.setIdentity();
  if (body.type == JointType::spherical) s.topRows<3>().setIdentity();
  if (body.type == JointType::revolute) s.topRows<3>() = body.axis;
  if (body.type == JointType::prismatic) s.bottomRows<3>() = body.axis;
  return s;
}

Transform joint_transform(const TreeBody& body, const VectorX& q) {
  Transform joint;
  const int first = body.first_position;
  if (body.type == JointType::floating) joint.r = q.segment<3>(first + 4);
  if (body.type == JointType::floating || body.type == JointType::spherical)
    joint.E = quaternion(q, first).toRotationMatrix().transpose();
  if (body.type == JointType::revolute) joint.E = Eigen::AngleAxisd(-q(first), body.axis).toRotationMatrix();
  if (body.type == JointType::prismatic) joint.r = q(first) * body.axis;
  return joint.after(body.from_parent);
}

Kinematics kinematics(const Tree& tree, const VectorX& q, const VectorX& v) {
  Kinematics k;
  for (int i = 0; i < tree.body_count(); ++i) {
    const TreeBody& b = tree.body(i);
    const Transform x = joint_transform(b, q);
    Vector6 velocity = motion_subspace(b) * v.segment(b.first_velocity, velocity_count(b.type));
    if (b.parent >= 0) velocity += x.motion() * k.velocity[b.parent];
    k.from_parent.push_back(x);
    k.from_world.push_back(b.parent >= 0 ? x.after(k.from_world[b.parent]) : x);
    k.velocity.push_back(velocity);
  }
  return k;
}

VectorX moved(const Tree& tree, const VectorX& q, const VectorX& v, double step) {
  VectorX next = q;
  for (int i = 0; i < tree.body_count(); ++i) {
    const TreeBody& b = tree.body(i);
    if (b.type == JointType::revolute || b.type == JointType::prismatic) {
      next(b.first_position) += step * v(b.first_velocity);
      continue;
    }
    if (b.type == JointType::floating) {
      const Matrix3 to_parent = quaternion(q, b.first_position).toRotationMatrix();
      next.segment<3>(b.first_position + 4) += step * (to_parent * v.segment<3>(b.first_velocity + 3));
    }
    turn(next, b.first_position, v.segment<3>(b.first_velocity), step);
  }
  return next;
}

Vector3 point_position(const Kinematics& k, int body, const Vector3& point_B) {
  return k.from_world[body].point_back(point_B);
}

Vector3 point_velocity(const Kinematics& k, int body, const Vector3& point_B) {
  const Vector6& v = k.velocity[body];
  return k.from_world[body].E.transpose() * (v.tail<3>() + v.head<3>().cross(point_B));
}

MatrixX point_jacobian(const Tree& tree, const Kinematics& k, int body, const Vector3& point_B) {
  MatrixX jacobian = MatrixX::Zero(3, tree.velocity_count());
  const Vector3 point = point_position(k, body, point_B);
  for (int i = body; i >= 0; i = tree.body(i).parent) {
    const TreeBody& b = tree.body(i);
    const Vector3 arm = k.from_world[i].point(point);
    const auto s = motion_subspace(b);
    const MatrixX at_point = s.bottomRows<3>() - skew(arm) * s.topRows<3>();
    jacobian.middleCols(b.first_velocity, at_point.cols()) = k.from_world[i].E.transpose() * at_point;
  }
  return jacobian;
}

Vector3 point_bias(const Tree& tree, const Kinematics& k, const VectorX& v, int body, const Vector3& point_B) {
  std::vector<int> path;
  for (int i = body; i >= 0; i = tree.body(i).parent) path.insert(path.begin(), i);
  Vector6 a = Vector6::Zero();
  for (const int i : path) {
    const TreeBody& b = tree.body(i);
    const Vector6 rate = motion_subspace(b) * v.segment(b.first_velocity, velocity_count(b.type));
    a = (k.from_parent[i].motion() * a + cross_motion(k.velocity[i], rate)).eval();
  }
  // Spatial acceleration to that of the point: a_O + w' x p + w x (velocity of the point) (RBDA section 2.11).
  const Vector3 w = k.velocity[body].head<3>(), along = k.velocity[body].tail<3>();
  const Vector3 at_point = a.tail<3>() + a.head<3>().cross(point_B) + w.cross(along + w.cross(point_B));
  return k.from_world[body].E.transpose() * at_point;
}

double kinetic_energy(const Tree& tree, const Kinematics& k) {
  double sum = 0;
  for (int i = 0; i < tree.body_count(); ++i) sum += 0.5 * k.velocity[i].dot(tree.body(i).inertia * k.velocity[i]);
  return sum;
}

double potential_energy(const Tree& tree, const Kinematics& k, const Vector3& gravity) {
  double sum = 0;
  for (int i = 0; i < tree.body_count(); ++i) {
    const Matrix6& inertia = tree.body(i).inertia;
    const double mass = inertia(3, 3);
    // mass times centre from the upper right block m [c x].
    const Vector3 moment(inertia(2, 4), inertia(0, 5), inertia(1, 3));
    sum -= gravity.dot(mass * k.from_world[i].r + k.from_world[i].E.transpose() * moment);
  }
  return sum;
}

}  // namespace gonogo::vehicle::multibody
