// One step of jointed bodies against a dense solution of the same step: constraints differentiated numerically from
// their definitions, springs implicit in the primal form, Lagrange multipliers by a full factorisation in double.
#include <Eigen/Dense>

#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr JointType kTypes[] = {JointType::revolute, JointType::spherical, JointType::prismatic, JointType::fixed,
                                JointType::distance, JointType::universal, JointType::in_line};
constexpr int kTypeCount = 7;
constexpr const char* kNames[] = {"revolute", "spherical", "prismatic", "fixed", "distance", "universal", "in_line"};

Joint random_joint(const SceneWorld& w, Draw& draw, JointType type, BodyIndex a, BodyIndex b) {
  const Vec3d point = (w.body[a].position + w.body[b].position) * 0.5 + draw.direction() * 0.1;
  const Vec3d axis = draw.direction();
  switch (type) {
    case JointType::revolute:
      return revolute(w, a, b, point, axis);
    case JointType::spherical:
      return spherical(w, a, b, point);
    case JointType::prismatic:
      return prismatic(w, a, b, point, axis);
    case JointType::fixed:
      return fixed(w, a, b, point);
    case JointType::distance:
      return distance(w, a, b, point, point + axis * 0.3);
    case JointType::in_line:
      return in_line(w, a, b, point, axis);
    default:
      return universal(w, a, b, point, axis, cross(axis, draw.direction()));
  }
}

/// Bodies at random places; those that spin have equal moments, so that no gyroscopic torque acts.
void add_random_body(SceneWorld& w, Draw& draw, const Vec3d& position) {
  const double mass = draw.magnitude(1, 1000), inertia = 0.1 * mass;
  BodyState state{position, draw.orientation(), static_cast<Vec3>(draw.direction()), {}};
  Vec3 moments{Real(inertia), Real(inertia), Real(inertia)};
  if (draw.below(2))
    state.angular_velocity = static_cast<Vec3>(draw.direction() * 2.0);
  else
    moments = {Real(inertia), Real(0.5 * inertia), Real(0.8 * inertia)};
  w.add_body(state, solid(Real(mass), moments));
}

/// A tree of five bodies on a fixed one, with joints of one type or of all, and three springs.
SceneWorld random_mechanism(std::uint64_t seed, int type) {
  Draw draw(7000 + 100 * std::uint64_t(type) + seed);
  SceneWorld w;
  w.origin = {-10, -10, -10};
  w.size = {20, 20, 20};
  w.add_body({{}, draw.orientation(), {}, {}}, fixed_body());
  for (int k = 1; k <= 5; ++k) add_random_body(w, draw, draw.direction() * (0.7 * k));
  for (BodyIndex k = 1; k <= 5; ++k)
    w.joint.push_back(
        random_joint(w, draw, kTypes[type < kTypeCount ? type : draw.below(kTypeCount)], k, draw.below(k)));
  for (int i = 0; i < 3; ++i) {
    const BodyIndex a = 1 + draw.below(5), b = (a + 1 + draw.below(5)) % 6;
    const Vec3d p = w.body[a].position + draw.direction() * 0.2, q = w.body[b].position + draw.direction() * 0.2;
    SpringDamper s = spring_along(w, a, b, p, q, draw.direction(), draw.magnitude(1e2, 1e7), draw.magnitude(1, 1e4));
    s.kind = SpringKind(i);
    s.free_length = measured(s, pose_of(w.body[a]), pose_of(w.body[b])) + draw.between(-0.01, 0.01);
    w.spring.push_back(s);
  }
  return w;
}

Pose nudged(Pose p, Eigen::Index number, double by) {
  double* const position[] = {&p.position.x, &p.position.y, &p.position.z};
  if (number < 3) return *position[number] += by, p;
  const Vec3d axis{number == 3 ? 1.0 : 0.0, number == 4 ? 1.0 : 0.0, number == 5 ? 1.0 : 0.0};
  for (Vec3d* v : {&p.x, &p.y, &p.z})
    *v = *v * std::cos(by) + cross(axis, *v) * std::sin(by) + axis * (dot(axis, *v) * (1 - std::cos(by)));
  return p;
}

/// Rows of f's derivative by the motion of all bodies; only those of a and b matter.
template <class F>
MatrixXd derivative(const F& f, const std::vector<Pose>& pose, BodyIndex a, BodyIndex b) {
  const double step = 1e-5;
  MatrixXd j = MatrixXd::Zero(Eigen::Index(f(pose[a], pose[b]).size()), Eigen::Index(6 * pose.size()));
  for (int side = 0; side < 2; ++side)
    for (Eigen::Index k = 0; k < 6; ++k) {
      const auto at = [&](double by) {
        return side == 0 ? f(nudged(pose[a], k, by), pose[b]) : f(pose[a], nudged(pose[b], k, by));
      };
      const auto high = at(step), low = at(-step);
      for (std::size_t r = 0; r < high.size(); ++r)
        j(Eigen::Index(r), 6 * (side == 0 ? a : b) + k) += (high[r] - low[r]) / (2 * step);
    }
  return j;
}

struct DenseStep {
  VectorXd velocity;
  std::vector<VectorXd> joint_impulse;  // J' p of each joint
};

/// Mass matrix, and in `free` the velocities at the end of the step without forces of joints and springs.
MatrixXd mass_matrix(const SceneWorld& w, const std::vector<Pose>& pose, double h, VectorXd& free) {
  const Eigen::Index n = Eigen::Index(6 * pose.size());
  MatrixXd mass = MatrixXd::Identity(n, n);
  free = VectorXd::Zero(n);
  for (std::size_t b = 1; b < pose.size(); ++b) {
    const Eigen::Index at = Eigen::Index(6 * b);
    const Vec3 i = w.mass[b].inverse_inertia_B;
    Eigen::Matrix3d r;
    for (int k = 0; k < 3; ++k) {
      const Vec3d& e = k == 0 ? pose[b].x : k == 1 ? pose[b].y : pose[b].z;
      r.col(k) << e.x, e.y, e.z;
    }
    mass.block<3, 3>(at, at) /= double(w.mass[b].inverse_mass.x);
    mass.block<3, 3>(at + 3, at + 3) =
        r * Eigen::Vector3d(1.0 / i.x, 1.0 / i.y, 1.0 / i.z).asDiagonal() * r.transpose();
    const Vec3 &v = w.body[b].velocity, &spin = w.body[b].angular_velocity;
    free.segment<6>(at) << v.x, v.y, v.z + h * w.gravity.z, spin.x, spin.y, spin.z;
  }
  return mass;
}

/// min 1/2 |v - v_free|_M^2 + 1/2 (h k + c) h u^2 + h f u  over all v with J v = 0.
DenseStep dense_step(const SceneWorld& w, double h) {
  std::vector<Pose> pose;
  for (const BodyState& s : w.body) pose.push_back(pose_of(s));
  const Eigen::Index n = Eigen::Index(6 * pose.size());
  VectorXd free;
  MatrixXd mass = mass_matrix(w, pose, h, free);
  VectorXd force = mass * free;
  for (const SpringDamper& s : w.spring) {
    const auto f = [&](const Pose& a, const Pose& b) { return std::vector<double>{measured(s, a, b)}; };
    const VectorXd j = derivative(f, pose, s.a.body, s.b.body).row(0);
    mass += h * (h * s.stiffness + s.damping) * j * j.transpose();
    force -= h * s.stiffness * (measured(s, pose[s.a.body], pose[s.b.body]) - s.free_length) * j;
  }
  std::vector<MatrixXd> of_joint{MatrixXd::Zero(6, n)};
  of_joint[0].leftCols(6).setIdentity();  // the fixed body
  Eigen::Index rows = 6;
  for (const Joint& joint : w.joint) {
    of_joint.push_back(derivative([&](const Pose& a, const Pose& b) { return constraints(joint, a, b); }, pose,
                                  joint.a.body, joint.b.body));
    rows += of_joint.back().rows();
  }
  MatrixXd all(rows, n);
  Eigen::Index next = 0;
  for (const MatrixXd& j : of_joint) {
    all.middleRows(next, j.rows()) = j;
    next += j.rows();
  }
  MatrixXd kkt = MatrixXd::Zero(n + rows, n + rows);
  kkt << mass, -all.transpose(), all, MatrixXd::Zero(rows, rows);
  VectorXd right = VectorXd::Zero(n + rows);
  right.head(n) = force;
  const VectorXd solution = kkt.fullPivLu().solve(right);
  DenseStep result{solution.head(n), {}};
  next = n + 6;
  for (std::size_t k = 1; k < of_joint.size(); next += of_joint[k++].rows())
    result.joint_impulse.push_back(of_joint[k].transpose() * solution.segment(next, of_joint[k].rows()));
  return result;
}

Eigen::Vector3d eigen(const Vec3d& v) { return {v.x, v.y, v.z}; }

}  // namespace

TEST_CASE("one step of every joint and of springs agrees with a dense solution of the same step") {
  const double h = 1e-3;
  for (const Backend backend : backends())
    for (int type = 0; type <= kTypeCount; ++type) {
      double worst = 0, worst_load = 0;
      for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const SceneWorld w = random_mechanism(seed, type);
        const auto simulation = simulate(backend, w, {});
        simulation->advance(1);
        const DenseStep oracle = dense_step(w, h);
        const auto after = simulation->bodies(0);
        for (std::size_t b = 1; b < after.size(); ++b) {
          const Vec3 &v = after[b].velocity, &s = after[b].angular_velocity;
          const Eigen::Index at = Eigen::Index(6 * b);
          worst = std::max(worst, (oracle.velocity.segment<3>(at) - Eigen::Vector3d(v.x, v.y, v.z)).norm());
          worst = std::max(worst, (oracle.velocity.segment<3>(at + 3) - Eigen::Vector3d(s.x, s.y, s.z)).norm());
        }
        for (std::size_t k = 0; k < w.joint.size(); ++k) {
          const JointLoad load = simulation->joint_load(0, Index(k));
          const BodyIndex a = w.joint[k].a.body;
          const Pose at = pose_of(w.body[a]);
          const VectorXd p = oracle.joint_impulse[k].segment<6>(6 * a) / h;
          const Eigen::Vector3d arm = eigen(at.direction(w.joint[k].a.point_B)), force = p.head<3>();
          const Eigen::Vector3d moment = p.tail<3>() - arm.cross(force);
          const double size = force.norm() + moment.norm() + 1;
          worst_load = std::max(worst_load, (eigen(load.force) - force).norm() / size);
          worst_load = std::max(worst_load, (eigen(load.moment) - moment).norm() / size);
        }
      }
      WARN(name_of(backend) << ", " << (type < kTypeCount ? kNames[type] : "all kinds") << ": largest velocity error "
                            << worst << " m/s or rad/s, of a joint's load " << worst_load);
      // Speeds are about 2 m/s and rad/s in single precision.
      CHECK(worst < 3e-6);
      CHECK(worst_load < 1e-5);
    }
}

TEST_CASE("flywheels on one shaft share a torque by their moments of inertia, wherever their axes point") {
  const double moment[] = {2, 5, 0.3}, torque = 4, seconds = 0.5;
  const Vec3d axis[] = {{0, 1, 0}, Vec3d{0.6, 0.8, 0}, {-1 / 3., 2 / 3., 2 / 3.}};
  SceneWorld w;
  w.origin = {-5, -5, -5};
  w.size = {10, 10, 10};
  const BodyIndex carrier = w.add_body({{}, {}, {}, {}}, fixed_body());
  BodyIndex wheel[3];
  for (int k = 0; k < 3; ++k) {
    const Vec3d at{double(k) - 1, 0, 0};
    wheel[k] = w.add_body({at, {}, {}, {}}, solid(10, {Real(moment[k]), Real(moment[k]), Real(moment[k])}));
    w.joint.push_back(revolute(w, wheel[k], carrier, at, axis[k]));
    if (k == 2) w.motor.push_back(torque_motor(w.joint.back(), torque));
    if (k > 0) w.joint.push_back(equal_spin(w, wheel[0], wheel[k], axis[0], axis[k]));
  }
  const double expected = torque * seconds / (moment[0] + moment[1] + moment[2]);
  for (const Backend backend : backends()) {
    const auto s = make_simulation(backend, {w}, {}, 1);
    advance_for(*s, seconds);
    for (int k = 0; k < 3; ++k) {
      const double spin = dot(static_cast<Vec3d>(s->body(0, wheel[k]).angular_velocity), axis[k]);
      CHECK(agrees(std::string(name_of(backend)) + ", spin of a wheel [rad/s]", expected, spin, 1e-5));
    }
  }
}
