#include "vehicle/multibody/loop.h"

namespace gonogo::vehicle::multibody {
namespace {

/// The relative motion of a loop's points.
struct Apart {
  Vector3 position, velocity, bias;
  MatrixX jacobian;
};

Apart apart(const Tree& tree, const Loop& l, const Kinematics& k, const VectorX& v) {
  return {point_position(k, l.second, l.second_point) - point_position(k, l.first, l.first_point),
          point_velocity(k, l.second, l.second_point) - point_velocity(k, l.first, l.first_point),
          point_bias(tree, k, v, l.second, l.second_point) - point_bias(tree, k, v, l.first, l.first_point),
          point_jacobian(tree, k, l.second, l.second_point) - point_jacobian(tree, k, l.first, l.first_point)};
}

int rows(const Loop& l) { return l.length > 0 ? 1 : 3; }

}  // namespace

LoopEquations loop_equations(const Tree& tree, const std::vector<Loop>& loops, const Kinematics& k, const VectorX& v) {
  int count = 0;
  for (const Loop& l : loops) count += rows(l);
  LoopEquations e{MatrixX(count, tree.velocity_count()), VectorX(count), VectorX(count)};
  int row = 0;
  for (const Loop& l : loops) {
    const Apart a = apart(tree, l, k, v);
    if (l.length > 0) {
      // |d| = length: u . d'' + (|d'|^2 - (u . d')^2) / |d| = 0.
      const double distance = a.position.norm();
      const Vector3 u = a.position / distance;
      const double along = u.dot(a.velocity);
      e.jacobian.row(row) = u.transpose() * a.jacobian;
      e.bias(row) = -u.dot(a.bias) - (a.velocity.squaredNorm() - along * along) / distance;
      e.error(row) = distance - l.length;
    } else {
      e.jacobian.middleRows<3>(row) = a.jacobian;
      e.bias.segment<3>(row) = -a.bias;
      e.error.segment<3>(row) = a.position;
    }
    row += rows(l);
  }
  return e;
}

LoopMotion forward_with_loops(const Tree& tree, const std::vector<Loop>& loops, const VectorX& q, const VectorX& v,
                              const VectorX& tau, const Vector3& gravity, const std::vector<Vector6>& external,
                              double stabilisation) {
  const LoopEquations e = loop_equations(tree, loops, kinematics(tree, q, v), v);
  const VectorX rest = VectorX::Zero(tree.velocity_count());
  const VectorX bias = inverse_dynamics(tree, q, v, rest, gravity, external);
  const Eigen::LLT<MatrixX> mass(mass_matrix_by_composites(tree, q));
  const VectorX free = mass.solve(tau - bias);
  const MatrixX response = mass.solve(e.jacobian.transpose());
  const VectorX pull = 2 * stabilisation * (e.jacobian * v) + stabilisation * stabilisation * e.error;
  LoopMotion m;
  m.force = (e.jacobian * response).completeOrthogonalDecomposition().solve(e.bias - pull - e.jacobian * free);
  m.acceleration = free + response * m.force;
  return m;
}

double close_loops(const Tree& tree, const std::vector<Loop>& loops, VectorX& q, const std::vector<int>& held) {
  const VectorX rest = VectorX::Zero(tree.velocity_count());
  double error = 0;
  for (int step = 0; step < 50; ++step) {
    LoopEquations e = loop_equations(tree, loops, kinematics(tree, q, rest), rest);
    error = e.error.size() > 0 ? e.error.cwiseAbs().maxCoeff() : 0;
    if (error < 1e-14) break;
    for (const int column : held) e.jacobian.col(column).setZero();
    q = moved(tree, q, e.jacobian.completeOrthogonalDecomposition().solve(-e.error), 1);
  }
  return error;
}

}  // namespace gonogo::vehicle::multibody
