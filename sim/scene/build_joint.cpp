#include "sim/scene/build_joint.h"

#include <cmath>
#include <string>

#include "base/error.h"

namespace gonogo::sim {
namespace {

const BodyState& body_of(const SceneWorld& world, BodyIndex b) {
  if (b < 0 || b >= BodyIndex(world.body.size()))
    throw InputError("body " + std::to_string(b) + " is to be joined but the world has " +
                     std::to_string(world.body.size()) + " bodies; add it first");
  return world.body[b];
}

Vec3d unit(const Vec3d& v) {
  const double size = length(v);
  if (!(size > 1e-9) || !std::isfinite(size))
    throw InputError("an axis of a joint, spring or motor has no direction; give a vector of some length");
  return v * (1 / size);
}

Vec3d rotate_back_precisely(const Quat& q, const Vec3d& v) {
  const Vec3d u{-double(q.x), -double(q.y), -double(q.z)};
  const double w = q.w, scale = 2 / (w * w + dot(u, u));
  const Vec3d t = cross(u, v);
  return v + scale * (w * t + cross(u, t));
}

/// Part of `side` at right angles to the unit vector `axis`; any direction there if nothing is left of it.
Vec3d side_across(const Vec3d& axis, const Vec3d& side) {
  const Vec3d across = side - axis * dot(side, axis);
  if (length(across) > 1e-6 * length(side) && length(side) > 0) return unit(across);
  return unit(cross(axis, std::fabs(axis.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
}

Joint joint_at(const SceneWorld& world, JointType type, BodyIndex a, BodyIndex b, const Vec3d& point_W,
               const Vec3d& axis_W) {
  Joint j;
  j.type = type;
  j.a = attach(world, a, point_W, axis_W);
  j.b = attach(world, b, point_W, axis_W);
  return j;
}

SpringDamper spring_on(SpringKind kind, const Attachment& a, const Attachment& b, double free_length, double stiffness,
                       double damping) {
  SpringDamper s;
  s.kind = kind;
  s.a = a;
  s.b = b;
  s.free_length = free_length;
  s.stiffness = Real(stiffness);
  s.damping = Real(damping);
  return s;
}

Motor motor_on(const Joint& revolute, MotorKind kind, double target, double max_torque) {
  Motor m;
  m.kind = kind;
  m.a = revolute.a.body;
  m.b = revolute.b.body;
  m.axis_B = revolute.b.axis_B;
  m.target = Real(target);
  m.max_torque = Real(max_torque);
  return m;
}

}  // namespace

Attachment attach(const SceneWorld& world, BodyIndex body, const Vec3d& point_W, const Vec3d& axis_W,
                  const Vec3d& side_W) {
  const BodyState& state = body_of(world, body);
  const Vec3d axis = unit(axis_W);
  Attachment at;
  at.body = body;
  at.point_B = static_cast<Vec3>(rotate_back_precisely(state.orientation, point_W - state.position));
  at.axis_B = static_cast<Vec3>(rotate_back_precisely(state.orientation, axis));
  at.side_B = static_cast<Vec3>(rotate_back_precisely(state.orientation, side_across(axis, side_W)));
  return at;
}

Joint revolute(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W) {
  return joint_at(world, JointType::revolute, a, b, point_W, axis_W);
}

Joint spherical(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W) {
  return joint_at(world, JointType::spherical, a, b, point_W, {0, 0, 1});
}

Joint prismatic(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W) {
  return joint_at(world, JointType::prismatic, a, b, point_W, axis_W);
}

Joint fixed(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W) {
  return joint_at(world, JointType::fixed, a, b, point_W, {0, 0, 1});
}

Joint in_line(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_W) {
  return joint_at(world, JointType::in_line, a, b, point_W, axis_W);
}

Joint distance(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_a_W, const Vec3d& point_b_W) {
  Joint j;
  j.type = JointType::distance;
  j.a = attach(world, a, point_a_W, {0, 0, 1});
  j.b = attach(world, b, point_b_W, {0, 0, 1});
  j.length = length(point_a_W - point_b_W);
  return j;
}

Joint universal(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_W, const Vec3d& axis_a_W,
                const Vec3d& axis_b_W) {
  Joint j;
  j.type = JointType::universal;
  j.a = attach(world, a, point_W, axis_a_W, axis_b_W);
  j.b = attach(world, b, point_W, axis_b_W, axis_a_W);
  return j;
}

SpringDamper spring_between(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_a_W,
                            const Vec3d& point_b_W, double stiffness, double damping) {
  return spring_on(SpringKind::linear, attach(world, a, point_a_W, {0, 0, 1}), attach(world, b, point_b_W, {0, 0, 1}),
                   length(point_a_W - point_b_W), stiffness, damping);
}

SpringDamper spring_along(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& point_a_W,
                          const Vec3d& point_b_W, const Vec3d& axis_W, double stiffness, double damping) {
  return spring_on(SpringKind::axial, attach(world, a, point_a_W, axis_W), attach(world, b, point_b_W, axis_W),
                   dot(point_a_W - point_b_W, unit(axis_W)), stiffness, damping);
}

SpringDamper spring_along(const Joint& prismatic, double free_length, double stiffness, double damping) {
  return spring_on(SpringKind::axial, prismatic.a, prismatic.b, free_length, stiffness, damping);
}

SpringDamper spring_about(const Joint& revolute, double free_angle, double stiffness, double damping) {
  return spring_on(SpringKind::torsional, revolute.a, revolute.b, free_angle, stiffness, damping);
}

Motor speed_motor(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& axis_W, double speed,
                  double max_torque) {
  Motor m;
  m.a = a;
  m.b = b;
  const Quat frame = b == kWorld ? Quat{} : body_of(world, b).orientation;
  m.axis_B = static_cast<Vec3>(rotate_back_precisely(frame, unit(axis_W)));
  m.target = Real(speed);
  m.max_torque = Real(max_torque);
  return m;
}

Motor speed_motor(const Joint& revolute, double speed, double max_torque) {
  return motor_on(revolute, MotorKind::speed, speed, max_torque);
}

Motor torque_motor(const Joint& revolute, double torque) { return motor_on(revolute, MotorKind::torque, torque, 0); }

ForceTable force_table(const std::vector<std::pair<double, double>>& points) {
  if (points.size() < 2 || points.size() > std::size_t(kMaxTablePoints))
    throw InputError("a spring's force table has " + std::to_string(points.size()) + " points; give 2 to " +
                     std::to_string(kMaxTablePoints));
  ForceTable t;
  t.count = std::int32_t(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    t.stretch[i] = Real(points[i].first);
    t.force[i] = Real(points[i].second);
  }
  return t;
}

}  // namespace gonogo::sim
