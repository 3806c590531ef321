#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "vehicle/multibody/dynamics.h"
#include "vehicle/multibody/handles.h"

namespace gonogo::vehicle::multibody {
namespace {

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

}  // namespace

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

}  // namespace gonogo::vehicle::multibody
