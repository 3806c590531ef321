// Every assembly of bodies is known by its equations of motion at its handles, a = Phi f + b: the joints that connect
// it to the rest. Two assemblies are joined at one joint, whose force is eliminated; going back down, each joint's
// force and acceleration follow from those at the handles of what it joined. All vectors in world coordinates about the
// world's origin, so that all handles of a rigid body have the same acceleration.
#include <algorithm>
#include <memory>

#include "vehicle/multibody/dynamics.h"

namespace gonogo::vehicle::multibody {
namespace {

using Subspace = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Ends of joints: handle 2 i is joint i on body i, handle 2 i + 1 on its parent.
struct Assembled {
  std::vector<int> handle;
  MatrixX phi;  // 6 x 6 block for every pair of handles
  VectorX b;

  int index(int h) const { return int(std::find(handle.begin(), handle.end(), h) - handle.begin()); }
};

/// A joint that two assemblies were joined at, for the way back.
struct Join {
  int joint = 0;
  Assembled child, parent;  // before joining; the ground is an assembly that does not move
  MatrixX v;                // W - W S D S^T W
  Subspace ws;              // W S
  MatrixX d;                // (S^T W S)^-1
  std::unique_ptr<Join> child_join, parent_join;
};

struct World {
  const Tree& tree;
  std::vector<Subspace> s{};        // S in world coordinates
  std::vector<Vector6> coriolis{};  // v x S qd
  std::vector<VectorX> tau{};
  std::vector<Matrix6> inverse_inertia{};
  std::vector<Vector6> free{};  // acceleration without handle forces, gravity taken off
};

World world_of(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau, const Vector3& gravity,
               const std::vector<Vector6>& external) {
  const Kinematics k = kinematics(tree, q, v);
  World w{.tree = tree};
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

Assembled single(const World& w, int body, const std::vector<int>& handles) {
  Assembled a{handles, MatrixX(6 * handles.size(), 6 * handles.size()), VectorX(6 * handles.size())};
  for (std::size_t i = 0; i < handles.size(); ++i) {
    a.b.segment<6>(6 * i) = w.free[body];
    for (std::size_t j = 0; j < handles.size(); ++j) a.phi.block<6, 6>(6 * i, 6 * j) = w.inverse_inertia[body];
  }
  return a;
}

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

/// Joins child and parent at a joint: its force f on the child (and -f on the parent) keeps a_child - a_parent = S qdd
/// + c with S^T f = tau. Fills the way back.
Assembled join(const World& w, Join& j) {
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

/// Bodies of `members` reachable from `start` without crossing `cut`.
std::vector<int> side_of(const Tree& tree, const std::vector<int>& members, int cut, bool below) {
  std::vector<int> result;
  for (const int i : members) {
    int at = i;
    while (at >= 0 && at != cut) at = tree.body(at).parent;
    if ((at == cut) == below) result.push_back(i);
  }
  return result;
}

/// The inner joint that halves the members best; inner joints are those of all members but the topmost.
int halving_joint(const Tree& tree, const std::vector<int>& members) {
  int best = members[1];
  std::size_t smallest = members.size() + 1;
  for (std::size_t m = 1; m < members.size(); ++m) {
    const std::size_t below = side_of(tree, members, members[m], true).size();
    const std::size_t larger = std::max(below, members.size() - below);
    if (larger < smallest) {
      smallest = larger;
      best = members[m];
    }
  }
  return best;
}

std::vector<int> handles_of(const Tree& tree, int body) {
  std::vector<int> handles{2 * body};
  for (int i = body + 1; i < tree.body_count(); ++i)
    if (tree.body(i).parent == body) handles.push_back(2 * i + 1);
  return handles;
}

/// Members ascend and are connected; the first is the topmost.
Assembled assemble(const World& w, const std::vector<int>& members, std::unique_ptr<Join>& back) {
  if (members.size() == 1) return single(w, members[0], handles_of(w.tree, members[0]));
  back = std::make_unique<Join>();
  back->joint = halving_joint(w.tree, members);
  back->child = assemble(w, side_of(w.tree, members, back->joint, true), back->child_join);
  back->parent = assemble(w, side_of(w.tree, members, back->joint, false), back->parent_join);
  return join(w, *back);
}

/// Way back: forces at the handles of what was joined are known, so the joint's acceleration and force follow.
void conquer(const World& w, const Join& j, std::vector<Vector6>& force, VectorX& dv) {
  const auto acceleration = [&](const Assembled& a, int h) {
    Vector6 sum = a.b.segment<6>(6 * a.index(h));
    for (std::size_t i = 0; i < a.handle.size(); ++i)
      if (a.handle[i] != h) sum += a.phi.block<6, 6>(6 * a.index(h), int(6 * i)) * force[a.handle[i]];
    return sum;
  };
  const int child = 2 * j.joint, parent = child + 1;
  const Vector6 apart = acceleration(j.child, child) - acceleration(j.parent, parent) - w.coriolis[j.joint];
  const VectorX own = j.d * (w.tau[j.joint] + j.ws.transpose() * apart);
  force[child] = j.ws * (j.d * w.tau[j.joint]) - j.v * apart;
  force[parent] = -force[child];
  dv.segment(w.tree.body(j.joint).first_velocity, own.size()) = own;
  if (j.child_join) conquer(w, *j.child_join, force, dv);
  if (j.parent_join) conquer(w, *j.parent_join, force, dv);
}

}  // namespace

VectorX forward_by_divide_and_conquer(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau,
                                      const Vector3& gravity, const std::vector<Vector6>& external) {
  const World w = world_of(tree, q, v, tau, gravity, external);
  VectorX dv(tree.velocity_count());
  std::vector<Vector6> force(2 * std::size_t(tree.body_count()), Vector6::Zero());
  for (int root = 0; root < tree.body_count(); ++root) {
    if (tree.body(root).parent >= 0) continue;
    std::vector<int> members;
    for (int i = root; i < tree.body_count(); ++i) {
      int top = i;
      while (tree.body(top).parent >= 0) top = tree.body(top).parent;
      if (top == root) members.push_back(i);
    }
    // Last, the whole is joined to the ground, whose handle does not accelerate.
    Join ground;
    ground.joint = root;
    ground.child = assemble(w, members, ground.child_join);
    ground.parent = {{2 * root + 1}, MatrixX::Zero(6, 6), VectorX::Zero(6)};
    join(w, ground);
    conquer(w, ground, force, dv);
  }
  return dv;
}

}  // namespace gonogo::vehicle::multibody
