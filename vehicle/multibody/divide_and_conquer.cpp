#include <algorithm>
#include <memory>

#include "vehicle/multibody/dynamics.h"
#include "vehicle/multibody/handles.h"

namespace gonogo::vehicle::multibody {
namespace {

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

}  // namespace

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

}  // namespace gonogo::vehicle::multibody
