#include "tests/sim/dense_problem.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace gonogo::test {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Column of D for an impulse `e` at a contact's point.
void add_push(MatrixXd& d, Eigen::Index column, const sim::Contact& c, const Vector3d& e) {
  d.block<3, 1>(6 * c.body_a, column) += e;
  d.block<3, 1>(6 * c.body_a + 3, column) += eigen(c.arm_a).cross(e);
  d.block<3, 1>(6 * c.body_b, column) -= e;
  d.block<3, 1>(6 * c.body_b + 3, column) -= eigen(c.arm_b).cross(e);
}

void add_turn(MatrixXd& d, Eigen::Index column, const sim::Contact& c, const Vector3d& e) {
  d.block<3, 1>(6 * c.body_a + 3, column) += e;
  d.block<3, 1>(6 * c.body_b + 3, column) -= e;
}

MatrixXd inverse_mass_matrix(const sim::SceneWorld& world, const std::vector<sim::BodyState>& bodies) {
  MatrixXd m = MatrixXd::Zero(6 * bodies.size(), 6 * bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Quat& q = bodies[b].orientation;
    const Matrix3d r = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
    m.block<3, 3>(6 * b, 6 * b) = eigen(world.mass[b].inverse_mass).asDiagonal();
    m.block<3, 3>(6 * b + 3, 6 * b + 3) = r * eigen(world.mass[b].inverse_inertia_B).asDiagonal() * r.transpose();
  }
  return m;
}

VectorXd free_velocity(const sim::SceneWorld& world, const std::vector<sim::BodyState>& bodies, double step) {
  VectorXd v(6 * bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vector3d moves = (eigen(world.mass[b].inverse_mass).array() > 0).cast<double>();
    v.segment<3>(6 * b) = eigen(bodies[b].velocity) + step * moves.cwiseProduct(eigen(world.gravity));
    v.segment<3>(6 * b + 3) = eigen(bodies[b].angular_velocity);
  }
  return v;
}

/// Nearest point of { n >= 0, |t| <= mu n, |r| <= rho n } by bisection over n, in the plain metric.
void project(Eigen::Ref<VectorXd> p, double mu, double rho) {
  const double slide = p.segment<2>(1).norm(), roll = p.segment<2>(3).norm(), n0 = p(0);
  const auto slope = [&](double n) {
    return n - n0 - mu * std::max(0.0, slide - mu * n) - rho * std::max(0.0, roll - rho * n);
  };
  double n = n0;
  if (n0 < 0 || slope(n0) < 0) {
    double low = std::max(0.0, n0), high = std::max(0.0, n0) + mu * slide + rho * roll;
    if (slope(0) >= 0) {
      high = low = 0;
    }
    for (int i = 0; i < 100 && high > low; ++i) {
      const double middle = (low + high) / 2;
      if (middle == low || middle == high) break;
      (slope(middle) > 0 ? high : low) = middle;
    }
    n = low;
  }
  p(0) = n;
  p.segment<2>(1) *= slide > mu * n ? mu * n / slide : 1;
  p.segment<2>(3) *= roll > rho * n ? rho * n / roll : 1;
}

/// The program in variables g = scale * g', with about a unit diagonal of N and the same cones.
class Scaled {
 public:
  explicit Scaled(const DenseProblem& p) : p_(p), scale_(p.bias.size()) {
    const MatrixXd n = p.hessian();
    const std::size_t contacts = p.mu.size();
    for (std::size_t c = 0; c < contacts; ++c) {
      const Eigen::Index at = Eigen::Index(5 * c);
      scale_.segment<3>(at).setConstant(1 / std::sqrt(n.diagonal().segment<3>(at).maxCoeff()));
      scale_.segment<2>(at + 3).setConstant(1 / std::sqrt(std::max(n.diagonal().segment<2>(at + 3).maxCoeff(), 1e-9)));
    }
    for (Eigen::Index m = 0; m < Eigen::Index(p.motor_limit.size()); ++m)
      scale_(Eigen::Index(5 * contacts) + m) =
          1 / std::sqrt(n(Eigen::Index(5 * contacts) + m, Eigen::Index(5 * contacts) + m));
    hessian = scale_.asDiagonal() * n * scale_.asDiagonal();
    gradient = scale_.asDiagonal() * (p.direction.transpose() * p.free_velocity + p.bias);
  }

  VectorXd projected(VectorXd z) const {
    const std::size_t contacts = p_.mu.size();
    for (std::size_t c = 0; c < contacts; ++c) {
      const Eigen::Index at = Eigen::Index(5 * c);
      const double shift = p_.cohesion[c] / scale_(at);
      z(at) += shift;
      project(z.segment(at, 5), p_.mu[c], p_.rho[c] * scale_(at) / scale_(at + 3));
      z(at) -= shift;
    }
    for (Eigen::Index m = 0; m < Eigen::Index(p_.motor_limit.size()); ++m) {
      const Eigen::Index at = Eigen::Index(5 * contacts) + m;
      const double limit = p_.motor_limit[std::size_t(m)] / scale_(at);
      z(at) = std::clamp(z(at), -limit, limit);
    }
    return z;
  }

  double residual(const VectorXd& z) const { return (z - projected(z - (hessian * z + gradient))).norm(); }
  VectorXd impulse(const VectorXd& z) const { return scale_.asDiagonal() * z; }

  MatrixXd hessian;
  VectorXd gradient;

 private:
  const DenseProblem& p_;
  VectorXd scale_;
};

}  // namespace

DenseProblem dense_problem(const sim::SceneWorld& world, const std::vector<sim::BodyState>& before,
                           const std::vector<sim::Contact>& contacts, double step) {
  const Eigen::Index motors = Eigen::Index(world.motor.size()), rows = Eigen::Index(5 * contacts.size()) + motors;
  DenseProblem p;
  p.direction = MatrixXd::Zero(Eigen::Index(6 * before.size()), rows);
  p.bias = VectorXd::Zero(rows);
  p.step = VectorXd::Zero(rows);
  p.inverse_mass = inverse_mass_matrix(world, before);
  p.free_velocity = free_velocity(world, before, step);
  Eigen::Index at = 0;
  for (const sim::Contact& c : contacts) {
    const Vector3d n = eigen(c.normal).normalized(), t = n.unitOrthogonal(), s = n.cross(t);
    add_push(p.direction, at, c, n);
    add_push(p.direction, at + 1, c, t);
    add_push(p.direction, at + 2, c, s);
    add_turn(p.direction, at + 3, c, t);
    add_turn(p.direction, at + 4, c, s);
    p.bias(at) = c.bias;
    p.step.segment<5>(at) << c.step.n, c.step.t, c.step.t, c.step.r, c.step.r;
    p.mu.push_back(c.mu);
    p.rho.push_back(c.rho);
    p.cohesion.push_back(c.cohesion);
    at += 5;
  }
  for (const sim::Motor& m : world.motor) {
    p.direction.block<3, 1>(6 * m.a + 3, at) = eigen(m.axis_B);  // motors of these scenes turn against the world
    p.bias(at) = -m.target;
    p.step(at) = 1 / (2 * p.direction.col(at).dot(p.inverse_mass * p.direction.col(at)));
    p.motor_limit.push_back(m.max_torque * step);
    ++at;
  }
  return p;
}

DenseSolution solve(const DenseProblem& problem, double tolerance, int max_iterations) {
  const Scaled q(problem);
  const Eigen::Index rows = problem.bias.size();
  const MatrixXd identity = MatrixXd::Identity(rows, rows);
  double penalty = 0.1;
  Eigen::LDLT<MatrixXd> factor(q.hessian + penalty * identity);
  VectorXd z = VectorXd::Zero(rows), u = z;
  DenseSolution s;
  for (s.iterations = 0; s.iterations < max_iterations; ++s.iterations) {
    const VectorXd g = factor.solve(penalty * (z - u) - q.gradient);
    const VectorXd relaxed = 1.6 * g - 0.6 * z, last = z;
    z = q.projected(relaxed + u);
    u += relaxed - z;
    if (s.iterations % 25 != 0) continue;
    s.residual = q.residual(z);
    if (s.residual < tolerance) break;
    const double primal = (g - z).norm(), dual = penalty * (z - last).norm();
    if (s.iterations > 5000 || (primal < 10 * dual && dual < 10 * primal)) continue;
    const double change = primal > dual ? 2 : 0.5;
    penalty *= change;
    u /= change;
    factor.compute(q.hessian + penalty * identity);
  }
  s.impulse = q.impulse(z);
  s.velocity = problem.free_velocity + problem.inverse_mass * (problem.direction * s.impulse);
  return s;
}

}  // namespace gonogo::test
