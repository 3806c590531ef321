#include "vehicle/multibody/handles.h"

#include <algorithm>

namespace gonogo::vehicle::multibody {
namespace {

/// Equations of two assemblies side by side.
Assembled beside(const Assembled& x, const Assembled& y) {
  Assembled a{x.handle, MatrixX::Zero(x.b.size() + y.b.size(), x.b.size() + y.b.size()),
              VectorX(x.b.size() + y.b.size())};
  a.handle.insert(a.handle.end(), y.handle.begin(), y.handle.end());
  a.phi.topLeftCorner(x.b.size(), x.b.size()) = x.phi;
  a.phi.bottomRightCorner(y.b.size(), y.b.size()) = y.phi;
  a.b << x.b, y.b;
  return a;
}

/// Rows of the handles that stay.
Assembled without(const Assembled& a, int first, int second) {
  std::vector<int> keep;
  Assembled r;
  for (std::size_t i = 0; i < a.handle.size(); ++i)
    if (a.handle[i] != first && a.handle[i] != second) {
      r.handle.push_back(a.handle[i]);
      for (int c = 0; c < 6; ++c) keep.push_back(int(6 * i) + c);
    }
  r.phi = a.phi(keep, keep);
  r.b = a.b(keep);
  return r;
}

std::vector<int> handles_of(const Tree& tree, int body) {
  std::vector<int> handles{2 * body};
  for (int i = body + 1; i < tree.body_count(); ++i)
    if (tree.body(i).parent == body) handles.push_back(2 * i + 1);
  return handles;
}

/// Acceleration of a handle of an assembly under the forces at its other handles.
Vector6 acceleration_of(const Assembled& a, int handle, const std::vector<Vector6>& force) {
  Vector6 sum = a.b.segment<6>(6 * a.index(handle));
  for (std::size_t i = 0; i < a.handle.size(); ++i)
    if (a.handle[i] != handle) sum += a.phi.block<6, 6>(6 * a.index(handle), int(6 * i)) * force[a.handle[i]];
  return sum;
}

}  // namespace

int Assembled::index(int h) const { return int(std::find(handle.begin(), handle.end(), h) - handle.begin()); }

Bodies bodies_of(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau, const Vector3& gravity,
                 const std::vector<Vector6>& external) {
  const Kinematics k = kinematics(tree, q, v);
  Bodies w{.tree = tree};
  Vector6 weight = Vector6::Zero();
  weight.tail<3>() = gravity;
  for (int i = 0; i < tree.body_count(); ++i) {
    const TreeBody& b = tree.body(i);
    const Transform back{k.from_world[i].E.transpose(), -(k.from_world[i].E * k.from_world[i].r)};
    const Matrix6 x = back.motion(), inverse = x * b.inertia.llt().solve(Matrix6(x.transpose()));
    const Vector6 velocity = x * k.velocity[i];
    const Matrix6 forward = k.from_world[i].motion();
    const Matrix6 inertia = forward.transpose() * b.inertia * forward;
    const Subspace s = x * motion_subspace(b);
    Vector6 force = -cross_force(velocity, inertia * velocity);
    if (!external.empty()) force += forward.transpose() * external[i];
    w.s.push_back(s);
    w.coriolis.push_back(cross_motion(velocity, s * v.segment(b.first_velocity, s.cols())));
    w.tau.push_back(tau.segment(b.first_velocity, s.cols()));
    w.inverse_inertia.push_back(inverse);
    w.free.push_back(inverse * force + weight);
  }
  return w;
}

Assembled single(const Bodies& w, int body) {
  const std::vector<int> handles = handles_of(w.tree, body);
  Assembled a{handles, MatrixX(6 * handles.size(), 6 * handles.size()), VectorX(6 * handles.size())};
  for (std::size_t i = 0; i < handles.size(); ++i) {
    a.b.segment<6>(6 * i) = w.free[body];
    for (std::size_t j = 0; j < handles.size(); ++j) a.phi.block<6, 6>(6 * i, 6 * j) = w.inverse_inertia[body];
  }
  return a;
}

Assembled ground(const Tree& tree) {
  Assembled a;
  for (int i = 0; i < tree.body_count(); ++i)
    if (tree.body(i).parent < 0) a.handle.push_back(2 * i + 1);
  a.phi = MatrixX::Zero(6 * a.handle.size(), 6 * a.handle.size());
  a.b = VectorX::Zero(6 * a.handle.size());
  return a;
}

Assembled join(const Bodies& w, Joined& j) {
  const Assembled all = beside(j.child, j.parent);
  const int child = 2 * j.joint, parent = child + 1, at_c = 6 * all.index(child), at_p = 6 * all.index(parent);
  const Matrix6 sum = all.phi.block<6, 6>(at_c, at_c) + all.phi.block<6, 6>(at_p, at_p);
  const Subspace& s = w.s[j.joint];
  const Matrix6 stiff = sum.ldlt().solve(Matrix6::Identity());
  j.ws = stiff * s;
  j.d = MatrixX(s.transpose() * j.ws).inverse();
  j.v = stiff - j.ws * j.d * j.ws.transpose();
  // f = -V (a difference without f - c) + W S D tau.
  const MatrixX column = all.phi.middleCols<6>(at_c) - all.phi.middleCols<6>(at_p);
  const Vector6 apart = all.b.segment<6>(at_c) - all.b.segment<6>(at_p) - w.coriolis[j.joint];
  Assembled result = all;
  result.phi -= column * j.v * column.transpose();
  result.b += column * (j.ws * (j.d * w.tau[j.joint]) - j.v * apart);
  return without(result, child, parent);
}

void open(const Bodies& w, const Joined& j, std::vector<Vector6>& force, VectorX& dv) {
  const int child = 2 * j.joint, parent = child + 1;
  const Vector6 apart =
      acceleration_of(j.child, child, force) - acceleration_of(j.parent, parent, force) - w.coriolis[j.joint];
  const VectorX own = j.d * (w.tau[j.joint] + j.ws.transpose() * apart);
  force[child] = j.ws * (j.d * w.tau[j.joint]) - j.v * apart;
  force[parent] = -force[child];
  dv.segment(w.tree.body(j.joint).first_velocity, own.size()) = own;
}

}  // namespace gonogo::vehicle::multibody
