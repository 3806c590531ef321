#include "vehicle/multibody/dynamics.h"

namespace gonogo::vehicle::multibody {
namespace {

using Subspace = Eigen::Matrix<double, 6, Eigen::Dynamic>;

Vector6 lifted(const Vector3& gravity) {
  Vector6 a = Vector6::Zero();
  a.tail<3>() = -gravity;
  return a;
}

Vector6 rate(const Subspace& s, const TreeBody& b, const VectorX& v) {
  return s * v.segment(b.first_velocity, s.cols());
}

/// Force of a body's motion at no acceleration, less the external one.
Vector6 bias_force(const Tree& tree, const Kinematics& k, int i, const std::vector<Vector6>& external) {
  const Vector6& v = k.velocity[i];
  Vector6 f = cross_force(v, tree.body(i).inertia * v);
  if (!external.empty()) f -= external[i];
  return f;
}

}  // namespace

VectorX inverse_dynamics(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& dv,
                         const Vector3& gravity, const std::vector<Vector6>& external) {
  const Kinematics k = kinematics(tree, q, v);
  const int n = tree.body_count();
  std::vector<Vector6> a(n), f(n);
  for (int i = 0; i < n; ++i) {
    const TreeBody& b = tree.body(i);
    const Subspace s = motion_subspace(b);
    a[i] = k.from_parent[i].motion() * (b.parent >= 0 ? a[b.parent] : lifted(gravity)) + rate(s, b, dv) +
           cross_motion(k.velocity[i], rate(s, b, v));
    f[i] = b.inertia * a[i] + bias_force(tree, k, i, external);
  }
  VectorX tau(tree.velocity_count());
  for (int i = n - 1; i >= 0; --i) {
    const TreeBody& b = tree.body(i);
    const Subspace s = motion_subspace(b);
    tau.segment(b.first_velocity, s.cols()) = s.transpose() * f[i];
    if (b.parent >= 0) f[b.parent] += k.from_parent[i].motion().transpose() * f[i];
  }
  return tau;
}

MatrixX mass_matrix_by_unit_vectors(const Tree& tree, const VectorX& q) {
  const int n = tree.velocity_count();
  const VectorX rest = VectorX::Zero(n);
  MatrixX m(n, n);
  for (int j = 0; j < n; ++j) m.col(j) = inverse_dynamics(tree, q, rest, VectorX::Unit(n, j), Vector3::Zero());
  return m;
}

MatrixX mass_matrix_by_composites(const Tree& tree, const VectorX& q) {
  const Kinematics k = kinematics(tree, q, VectorX::Zero(tree.velocity_count()));
  const int n = tree.body_count();
  std::vector<Matrix6> composite(n);
  for (int i = 0; i < n; ++i) composite[i] = tree.body(i).inertia;
  MatrixX m = MatrixX::Zero(tree.velocity_count(), tree.velocity_count());
  for (int i = n - 1; i >= 0; --i) {
    const TreeBody& b = tree.body(i);
    const Subspace s = motion_subspace(b);
    if (b.parent >= 0) {
      const Matrix6 x = k.from_parent[i].motion();
      composite[b.parent] += x.transpose() * composite[i] * x;
    }
    Subspace f = composite[i] * s;
    m.block(b.first_velocity, b.first_velocity, s.cols(), s.cols()) = s.transpose() * f;
    for (int j = i; tree.body(j).parent >= 0;) {
      f = (k.from_parent[j].motion().transpose() * f).eval();
      j = tree.body(j).parent;
      const TreeBody& above = tree.body(j);
      const MatrixX block = f.transpose() * motion_subspace(above);
      m.block(b.first_velocity, above.first_velocity, block.rows(), block.cols()) = block;
      m.block(above.first_velocity, b.first_velocity, block.cols(), block.rows()) = block.transpose();
    }
  }
  return m;
}

VectorX forward_by_articulated_bodies(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau,
                                      const Vector3& gravity, const std::vector<Vector6>& external) {
  const Kinematics k = kinematics(tree, q, v);
  const int n = tree.body_count();
  std::vector<Matrix6> inertia(n);  // articulated
  std::vector<Vector6> force(n), coriolis(n);
  for (int i = 0; i < n; ++i) {
    const TreeBody& b = tree.body(i);
    inertia[i] = b.inertia;
    force[i] = bias_force(tree, k, i, external);
    coriolis[i] = cross_motion(k.velocity[i], rate(motion_subspace(b), b, v));
  }
  std::vector<Subspace> u(n);    // I^A S
  std::vector<MatrixX> d(n);     // (S^T I^A S)^-1
  std::vector<VectorX> left(n);  // tau - S^T p^A
  for (int i = n - 1; i >= 0; --i) {
    const TreeBody& b = tree.body(i);
    const Subspace s = motion_subspace(b);
    u[i] = inertia[i] * s;
    d[i] = MatrixX(s.transpose() * u[i]).inverse();
    left[i] = tau.segment(b.first_velocity, s.cols()) - s.transpose() * force[i];
    if (b.parent < 0) continue;
    const Matrix6 x = k.from_parent[i].motion();
    const Matrix6 seen = inertia[i] - u[i] * d[i] * u[i].transpose();
    const Vector6 p = force[i] + seen * coriolis[i] + u[i] * (d[i] * left[i]);
    inertia[b.parent] += x.transpose() * seen * x;
    force[b.parent] += x.transpose() * p;
  }
  VectorX dv(tree.velocity_count());
  std::vector<Vector6> a(n);
  for (int i = 0; i < n; ++i) {
    const TreeBody& b = tree.body(i);
    const Vector6 carried = k.from_parent[i].motion() * (b.parent >= 0 ? a[b.parent] : lifted(gravity)) + coriolis[i];
    const VectorX own = d[i] * (left[i] - u[i].transpose() * carried);
    dv.segment(b.first_velocity, own.size()) = own;
    a[i] = carried + motion_subspace(b) * own;
  }
  return dv;
}

}  // namespace gonogo::vehicle::multibody
