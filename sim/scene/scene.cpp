#include "sim/scene/scene.h"

#include <Eigen/Dense>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/units.h"
#include "sim/shape/sphere_cover.h"

namespace gonogo::sim {

BodyMass fixed_body() { return {}; }

BodyMass solid(Real mass, const Vec3& inertia_B) {
  if (!(mass > 0) || !(inertia_B.x > 0) || !(inertia_B.y > 0) || !(inertia_B.z > 0))
    throw InputError("a body has the mass " + std::to_string(mass) + " kg and the moments of inertia " +
                     std::to_string(inertia_B.x) + ", " + std::to_string(inertia_B.y) + ", " +
                     std::to_string(inertia_B.z) +
                     " kg m^2; all must be above zero, or use fixed_body() for a body that stays");
  BodyMass m;
  m.inverse_mass = {1 / mass, 1 / mass, 1 / mass};
  m.inverse_inertia_B = {1 / inertia_B.x, 1 / inertia_B.y, 1 / inertia_B.z};
  m.isotropic = inertia_B.x == inertia_B.y && inertia_B.y == inertia_B.z;
  return m;
}

SceneWorld vacant_world() {
  SceneWorld w;
  w.add_body({}, fixed_body());
  return w;
}

BodyIndex SceneWorld::add_body(const BodyState& state, const BodyMass& body_mass) {
  body.push_back(state);
  mass.push_back(body_mass);
  return BodyIndex(body.size()) - 1;
}

BodyIndex SceneWorld::add_sphere(const Vec3d& position, Real radius, Real density, int material) {
  const Real m = density * Real(4.0 / 3.0 * kPi) * radius * radius * radius;
  const Real inertia = Real(0.4) * m * radius * radius;
  const BodyIndex b = add_body({position, {}, {}, {}}, solid(m, {inertia, inertia, inertia}));
  Shape s;
  s.body = b;
  s.material = material;
  s.size = {radius, 0, 0};
  add_shape(s);
  return b;
}

BodyIndex SceneWorld::add_ellipsoid(const BodyState& state, const Vec3& half, Real density, int material) {
  const double x = double(half.x) * half.x, y = double(half.y) * half.y, z = double(half.z) * half.z;
  const double m = double(density) * 4.0 / 3.0 * kPi * half.x * half.y * half.z;
  const Vec3 inertia{Real(m / 5 * (y + z)), Real(m / 5 * (x + z)), Real(m / 5 * (x + y))};
  const BodyIndex b = add_body(state, solid(Real(m), inertia));
  Shape s;
  s.type = ShapeType::ellipsoid;
  s.body = b;
  s.material = material;
  s.size = half;
  add_shape(s);
  return b;
}

void SceneWorld::add_shape(const Shape& s) {
  if (s.body < 0 || s.body >= BodyIndex(body.size()) || (!shape.empty() && shape.back().body > s.body))
    throw InputError("shapes must be added in ascending order of their body, after it exists");
  shape.push_back(s);
}

std::int32_t SceneWorld::add_mesh(TriangleMesh m) {
  check_mesh(m);
  mesh.push_back(std::make_shared<const TriangleMesh>(std::move(m)));
  return std::int32_t(mesh.size()) - 1;
}

std::int32_t SceneWorld::add_heightfield(Heightfield f) {
  check_heightfield(f);
  heightfield.push_back(std::make_shared<const Heightfield>(std::move(f)));
  return std::int32_t(heightfield.size()) - 1;
}

void SceneWorld::set_law(int material_a, int material_b, const PairLaw& l) {
  law[material_a][material_b] = l;
  law[material_b][material_a] = l;
}

void SceneWorld::set_penalty(int material_a, int material_b, const PenaltyLaw& l) {
  penalty[material_a][material_b] = l;
  penalty[material_b][material_a] = l;
}

namespace {

struct Principal {
  Vec3d inertia;  // over the density [m^5]
  Quat turn;      // from the principal axes to the mesh's
};

Principal principal_axes(const SolidMoments& moments) {
  Eigen::Matrix3d inertia;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) inertia(i, j) = moments.inertia[i][j];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  const Eigen::Quaterniond q(axes);
  const Eigen::Vector3d& values = solver.eigenvalues();
  return {{values[0], values[1], values[2]}, {Real(q.w()), Real(q.x()), Real(q.y()), Real(q.z())}};
}

}  // namespace

BodyIndex add_compound(SceneWorld& world, const BodyState& at, const TriangleMesh& mesh, const SphereCover& cover,
                       double density, int material) {
  const SolidMoments moments = moments_of(mesh);
  if (!(density > 0) || !(moments.volume > 0))
    throw InputError("a compound of the mesh '" + mesh.name + "' needs a density and a volume above zero, not " +
                     std::to_string(density) + " kg/m^3 and " + std::to_string(moments.volume) + " m^3");
  const Principal principal = principal_axes(moments);
  BodyState state = at;
  state.position += static_cast<Vec3d>(rotate(at.orientation, static_cast<Vec3>(moments.centre)));
  state.orientation = normalised(at.orientation * principal.turn);
  const Vec3d inertia = principal.inertia * density;
  const BodyIndex body = world.add_body(state, solid(Real(density * moments.volume), static_cast<Vec3>(inertia)));
  for (const CoverSphere& sphere : cover.sphere) {
    Shape s;
    s.body = body;
    s.material = material;
    s.size = {Real(sphere.radius), 0, 0};
    s.offset_B = rotate_back(principal.turn, static_cast<Vec3>(sphere.centre - moments.centre));
    world.add_shape(s);
  }
  return body;
}

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

Joint equal_spin(const SceneWorld& world, BodyIndex a, BodyIndex b, const Vec3d& axis_a_W, const Vec3d& axis_b_W) {
  Joint j;
  j.type = JointType::equal_spin;
  j.a = attach(world, a, body_of(world, a).position, axis_a_W);
  j.b = attach(world, b, body_of(world, b).position, axis_b_W);
  return j;
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
