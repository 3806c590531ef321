#include "vehicle/multibody/dynamics.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "base/error.h"

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

// Assemblies of bodies by their equations of motion at their handles, a = Phi f + b: the joints that connect them to
// the rest. Two assemblies are joined at one joint, whose force is eliminated; on the way back the joint's force and
// acceleration follow from the forces at the handles of what it joined. All vectors are in world coordinates about the
// world's origin, so that all handles of a rigid body have the same acceleration.

/// Ends of joints: handle 2 i is joint i on body i, handle 2 i + 1 on its parent.
struct Assembled {
  std::vector<int> handle;
  MatrixX phi;  // 6 x 6 block for every pair of handles
  VectorX b;

  /// Place of a handle; the number of handles when it is not there.
  int index(int h) const;
};

/// A joint that two assemblies were joined at, for the way back.
struct Joined {
  int joint = 0;
  Assembled child, parent;  // before joining
  MatrixX v = {};           // W - W S D S^T W
  Subspace ws = {};         // W S
  MatrixX d = {};           // (S^T W S)^-1
};

/// Bodies in world coordinates.
struct Bodies {
  const Tree& tree;
  std::vector<Subspace> s{};        // S in world coordinates
  std::vector<Vector6> coriolis{};  // v x S qd
  std::vector<VectorX> tau{};
  std::vector<Matrix6> inverse_inertia{};
  std::vector<Vector6> free{};  // acceleration without handle forces, gravity taken off
};

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

int Assembled::index(int h) const { return int(std::find(handle.begin(), handle.end(), h) - handle.begin()); }

/// Arguments as of forward_by_articulated_bodies().
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

/// One body and its joints.
Assembled single(const Bodies& w, int body) {
  const std::vector<int> handles = handles_of(w.tree, body);
  Assembled a{handles, MatrixX(6 * handles.size(), 6 * handles.size()), VectorX(6 * handles.size())};
  for (std::size_t i = 0; i < handles.size(); ++i) {
    a.b.segment<6>(6 * i) = w.free[body];
    for (std::size_t j = 0; j < handles.size(); ++j) a.phi.block<6, 6>(6 * i, 6 * j) = w.inverse_inertia[body];
  }
  return a;
}

/// The world, which does not move, with a handle for every body that is joined to it.
Assembled ground(const Tree& tree) {
  Assembled a;
  for (int i = 0; i < tree.body_count(); ++i)
    if (tree.body(i).parent < 0) a.handle.push_back(2 * i + 1);
  a.phi = MatrixX::Zero(6 * a.handle.size(), 6 * a.handle.size());
  a.b = VectorX::Zero(6 * a.handle.size());
  return a;
}

/// Joins child and parent at a joint: its force f on the child (and -f on the parent) keeps a_child - a_parent = S qdd
/// + c with S^T f = tau. Fills the way back.
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

/// The way back: from the forces at the handles of what was joined, the joint's own force and acceleration.
void open(const Bodies& w, const Joined& j, std::vector<Vector6>& force, VectorX& dv) {
  const int child = 2 * j.joint, parent = child + 1;
  const Vector6 apart =
      acceleration_of(j.child, child, force) - acceleration_of(j.parent, parent, force) - w.coriolis[j.joint];
  const VectorX own = j.d * (w.tau[j.joint] + j.ws.transpose() * apart);
  force[child] = j.ws * (j.d * w.tau[j.joint]) - j.v * apart;
  force[parent] = -force[child];
  dv.segment(w.tree.body(j.joint).first_velocity, own.size()) = own;
}

struct Half {
  Joined joined;
  std::unique_ptr<Half> child = {}, parent = {};  // of the assemblies that were joined; none for one body
};

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

/// Members ascend and are connected; the first is the topmost.
Assembled assemble(const Bodies& w, const std::vector<int>& members, std::unique_ptr<Half>& back) {
  if (members.size() == 1) return single(w, members[0]);
  back = std::make_unique<Half>();
  const int joint = back->joined.joint = halving_joint(w.tree, members);
  back->joined.child = assemble(w, side_of(w.tree, members, joint, true), back->child);
  back->joined.parent = assemble(w, side_of(w.tree, members, joint, false), back->parent);
  return join(w, back->joined);
}

void conquer(const Bodies& w, const Half& half, std::vector<Vector6>& force, VectorX& dv) {
  open(w, half.joined, force, dv);
  if (half.child) conquer(w, *half.child, force, dv);
  if (half.parent) conquer(w, *half.parent, force, dv);
}

/// Tips first: each joint then adds the tree below it, known at one handle, to a single body.
std::vector<int> serial_order(const Tree& tree) {
  std::vector<int> order(std::size_t(tree.body_count()));
  std::iota(order.rbegin(), order.rend(), 0);
  return order;
}

void check_order(const Tree& tree, std::vector<int> order) {
  std::sort(order.begin(), order.end());
  for (int i = 0; i < int(order.size()); ++i)
    if (order[std::size_t(i)] != i || int(order.size()) != tree.body_count())
      throw InputError("the order of assembly must name each of the " + std::to_string(tree.body_count()) +
                       " joints once");
}

/// Assemblies by the bodies that they hold; the last one holds the ground.
class Assemblies {
 public:
  explicit Assemblies(const Bodies& w) : above_(std::size_t(w.tree.body_count()) + 1) {
    std::iota(above_.begin(), above_.end(), 0);
    for (int i = 0; i < w.tree.body_count(); ++i) of_.push_back(single(w, i));
    of_.push_back(ground(w.tree));
  }
  int ground_place() const { return int(of_.size()) - 1; }

  Assembled take(int body) { return std::move(of_[std::size_t(find(body))]); }
  /// The two assemblies of these bodies become one.
  void put(int child, int parent, Assembled joined) {
    above_[std::size_t(find(child))] = find(parent);
    of_[std::size_t(find(parent))] = std::move(joined);
  }

 private:
  int find(int i) {
    while (above_[std::size_t(i)] != i) i = above_[std::size_t(i)] = above_[std::size_t(above_[std::size_t(i)])];
    return i;
  }
  std::vector<int> above_;
  std::vector<Assembled> of_;
};

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

VectorX forward_by_divide_and_conquer(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau,
                                      const Vector3& gravity, const std::vector<Vector6>& external) {
  const Bodies w = bodies_of(tree, q, v, tau, gravity, external);
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
    Half whole;
    whole.joined.joint = root;
    whole.joined.child = assemble(w, members, whole.child);
    whole.joined.parent = {{2 * root + 1}, MatrixX::Zero(6, 6), VectorX::Zero(6)};
    join(w, whole.joined);
    conquer(w, whole, force, dv);
  }
  return dv;
}

VectorX forward_by_assembly(const Tree& tree, const VectorX& q, const VectorX& v, const VectorX& tau,
                            const Vector3& gravity, const std::vector<Vector6>& external,
                            const std::vector<int>& order) {
  const std::vector<int> sequence = order.empty() ? serial_order(tree) : order;
  check_order(tree, sequence);
  const Bodies w = bodies_of(tree, q, v, tau, gravity, external);
  Assemblies assemblies(w);
  std::vector<Joined> joined;
  for (const int joint : sequence) {
    const int above = tree.body(joint).parent, parent = above < 0 ? assemblies.ground_place() : above;
    joined.push_back({.joint = joint, .child = assemblies.take(joint), .parent = assemblies.take(parent)});
    assemblies.put(joint, parent, join(w, joined.back()));
  }
  VectorX dv(tree.velocity_count());
  std::vector<Vector6> force(2 * std::size_t(tree.body_count()), Vector6::Zero());
  for (auto j = joined.rbegin(); j != joined.rend(); ++j) open(w, *j, force, dv);
  return dv;
}

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
