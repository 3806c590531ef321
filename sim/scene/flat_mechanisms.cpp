#include "sim/scene/flat_mechanisms.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"

namespace gonogo::sim {
namespace {

/// Components of a graph of bodies, each named by its smallest body.
class Components {
 public:
  explicit Components(std::size_t bodies) : parent_(bodies) { std::iota(parent_.begin(), parent_.end(), 0); }
  BodyIndex of(BodyIndex b) {
    while (parent_[b] != b) b = parent_[b] = parent_[parent_[b]];
    return b;
  }
  void join(BodyIndex a, BodyIndex b) {
    a = of(a);
    b = of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<BodyIndex> parent_;
};

using Pair = std::pair<Index, Index>;

/// Order of elements, given by the slots that each connects (-1: none), in which few zeros of A fill up: always one of
/// those with the fewest neighbours next (minimum degree, Tinney & Walker 1967). Its neighbours then see each other.
std::vector<std::size_t> elimination_order(const std::vector<Pair>& slots) {
  const std::size_t count = slots.size();
  std::vector<std::vector<bool>> sees(count, std::vector<bool>(count));
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      for (const Index slot : {slots[i].first, slots[i].second})
        if (i != j && slot >= 0 && (slot == slots[j].first || slot == slots[j].second)) sees[i][j] = true;
  std::vector<bool> taken(count);
  std::vector<std::size_t> order;
  const auto degree = [&](std::size_t i) {
    std::size_t sum = 0;
    for (std::size_t j = 0; j < count; ++j) sum += !taken[j] && sees[i][j];
    return sum;
  };
  while (order.size() < count) {
    std::size_t next = count;
    for (std::size_t i = 0; i < count; ++i)
      if (!taken[i] && (next == count || degree(i) < degree(next))) next = i;
    taken[next] = true;
    order.push_back(next);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j)
        if (i != j && sees[next][i] && sees[next][j]) sees[i][j] = true;
  }
  return order;
}

class Flattener {
 public:
  Flattener(const SceneWorld& world, const std::string& where) : world_(world), where_(where) {
    flat_.joint = world.joint;
    flat_.spring = world.spring;
    flat_.motor = world.motor;
    flat_.slot_of_body.assign(world.body.size(), -1);
    flat_.row_of_joint.resize(world.joint.size());
    flat_.row_of_spring.resize(world.spring.size());
  }

  FlatMechanisms flatten() {
    Components components(world_.body.size());
    std::vector<bool> used(world_.body.size());
    for_each_pair([&](BodyIndex a, BodyIndex b) {
      for (const BodyIndex body : {a, b})
        if (moves(body)) used[body] = true;
      if (moves(a) && moves(b)) components.join(a, b);
    });
    std::vector<std::vector<BodyIndex>> members(world_.body.size());
    for (BodyIndex b = 0; b < BodyIndex(world_.body.size()); ++b)
      if (used[b]) members[components.of(b)].push_back(b);
    for (const auto& group : members)
      if (!group.empty()) add_mechanism(group);
    return std::move(flat_);
  }

 private:
  bool moves(BodyIndex b) const { return b != kWorld && !is_fixed(world_.mass[b]); }

  template <class F>
  void for_each_pair(const F& f) const {
    for (const Joint& j : world_.joint) f(j.a.body, j.b.body);
    for (const SpringDamper& s : world_.spring) f(s.a.body, s.b.body);
    for (const Motor& m : world_.motor) f(m.a, m.b);
  }

  void add_mechanism(const std::vector<BodyIndex>& group) {
    mechanism_ = {};
    mechanism_.first_body = Index(flat_.body.size());
    mechanism_.body_count = Index(group.size());
    mechanism_.first_element = Index(flat_.element.size());
    mechanism_.first_row = flat_.rows;
    for (std::size_t k = 0; k < group.size(); ++k) {
      flat_.slot_of_body[group[k]] = mechanism_.first_body + Index(k);
      flat_.body.push_back({group[k], Index(flat_.mechanism.size())});
    }
    add_elements();
    check_capacity();
    add_entries();
    mechanism_.system = flat_.system;
    mechanism_.projection = flat_.projection;
    flat_.rows += mechanism_.row_count;
    flat_.system += mechanism_.system_size();
    flat_.projection += mechanism_.projection_size();
    flat_.mechanism.push_back(mechanism_);
  }

  /// Index of a body in the mechanism at hand, or -1.
  Index slot(BodyIndex b) const {
    if (b == kWorld || flat_.slot_of_body[b] < mechanism_.first_body) return -1;
    return flat_.slot_of_body[b] - mechanism_.first_body;
  }

  void add_elements() {
    for (std::size_t i = 0; i < flat_.joint.size(); ++i)
      if (place(flat_.joint[i].a, flat_.joint[i].b)) flat_.element.push_back({ElementKind::joint, Index(i), 0});
    for (std::size_t i = 0; i < flat_.spring.size(); ++i)
      if (place(flat_.spring[i].a, flat_.spring[i].b)) flat_.element.push_back({ElementKind::spring, Index(i), 0});
    number_rows();
    for (std::size_t i = 0; i < flat_.motor.size(); ++i) {
      Motor& m = flat_.motor[i];
      if (slot(m.a) < 0 && slot(m.b) < 0) continue;
      m.slot_a = slot(m.a);
      m.slot_b = slot(m.b);
      flat_.element.push_back({ElementKind::motor, Index(i), 0});
      ++mechanism_.motor_count;
    }
    mechanism_.element_count = Index(flat_.element.size()) - mechanism_.first_element;
  }

  /// Rows in the order in which their elements are eliminated.
  void number_rows() {
    std::vector<Pair> slots;
    for (std::size_t e = mechanism_.first_element; e < flat_.element.size(); ++e)
      slots.push_back(slots_of(flat_.element[e]));
    for (const std::size_t k : elimination_order(slots)) {
      Element& e = flat_.element[std::size_t(mechanism_.first_element) + k];
      e.row = mechanism_.row_count;
      auto& first_row = e.kind == ElementKind::joint ? flat_.row_of_joint : flat_.row_of_spring;
      first_row[e.index] = mechanism_.first_row + e.row;
      mechanism_.row_count += rows_of(e);
    }
  }

  Pair slots_of(const Element& e) const {
    if (e.kind == ElementKind::joint) return {flat_.joint[e.index].a.slot, flat_.joint[e.index].b.slot};
    return {flat_.spring[e.index].a.slot, flat_.spring[e.index].b.slot};
  }

  Index rows_of(const Element& e) const {
    return e.kind == ElementKind::joint ? row_count(flat_.joint[e.index].type) : 1;
  }

  /// Whether a pair belongs to the mechanism at hand.
  bool place(Attachment& a, Attachment& b) const {
    if (slot(a.body) < 0 && slot(b.body) < 0) return false;
    a.slot = slot(a.body);
    b.slot = slot(b.body);
    return true;
  }

  void check_capacity() const {
    if (mechanism_.body_count <= kMaxMechanismBodies && mechanism_.row_count <= kMaxMechanismRows) return;
    throw InputError(where_ + "a mechanism of " + std::to_string(mechanism_.body_count) + " bodies and " +
                     std::to_string(mechanism_.row_count) + " equations is too large; the engine holds " +
                     std::to_string(kMaxMechanismBodies) + " bodies and " + std::to_string(kMaxMechanismRows) +
                     " equations that are joined together");
  }

  /// Lists what acts on each body.
  void add_entries() {
    const auto elements = flat_.element.begin() + mechanism_.first_element;
    for (Index k = 0; k < mechanism_.body_count; ++k) {
      MechanismBody& body = flat_.body[mechanism_.first_body + k];
      body.driven = mechanism_.motor_count > 0;
      body.first_row_entry = Index(flat_.row_entry.size());
      body.first_motor_entry = Index(flat_.motor_entry.size());
      for (auto e = elements; e != elements + mechanism_.element_count; ++e) add_entries_of(*e, k);
      body.end_row_entry = Index(flat_.row_entry.size());
      body.end_motor_entry = Index(flat_.motor_entry.size());
    }
  }

  void add_entries_of(const Element& e, Index slot) {
    if (e.kind == ElementKind::motor) {
      const Motor& m = flat_.motor[e.index];
      if (m.slot_a == slot) flat_.motor_entry.push_back(2 * e.index);
      if (m.slot_b == slot) flat_.motor_entry.push_back(2 * e.index + 1);
      return;
    }
    const Pair at = slots_of(e);
    for (Index r = e.row; r < e.row + rows_of(e); ++r) {
      if (at.first == slot) flat_.row_entry.push_back(2 * r);
      if (at.second == slot) flat_.row_entry.push_back(2 * r + 1);
    }
  }

  const SceneWorld& world_;
  const std::string& where_;
  FlatMechanisms flat_;
  Mechanism mechanism_;
};

}  // namespace

MechanismSize operator+(const MechanismSize& a, const MechanismSize& b) {
  MechanismSize sum;
  for (const MechanismPart& part : kMechanismParts) sum.*part.count = a.*part.count + b.*part.count;
  return sum;
}

MechanismSize larger(const MechanismSize& a, const MechanismSize& b) {
  MechanismSize max;
  for (const MechanismPart& part : kMechanismParts) max.*part.count = std::max(a.*part.count, b.*part.count);
  return max;
}

MechanismSize FlatMechanisms::size() const {
  return {Index(mechanism.size()),
          Index(body.size()),
          Index(row_entry.size()),
          Index(motor_entry.size()),
          Index(element.size()),
          Index(joint.size()),
          Index(spring.size()),
          Index(motor.size()),
          rows,
          system,
          projection};
}

FlatMechanisms flatten_mechanisms(const SceneWorld& world, const std::string& where) {
  GONOGO_ASSERT(world.mass.size() == world.body.size());
  return Flattener(world, where).flatten();
}

FlatMechanisms moved(FlatMechanisms flat, const MechanismSize& begin, WorldIndex world, BodyIndex first_body) {
  for (Mechanism& m : flat.mechanism) {
    m.world = world;
    m.first_body += begin.bodies;
    m.first_element += begin.elements;
    m.first_row += begin.rows;
    m.system += begin.system;
    m.projection += begin.projection;
  }
  for (MechanismBody& b : flat.body) {
    b.body += first_body;
    b.mechanism += begin.mechanisms;
    b.first_row_entry += begin.row_entries;
    b.end_row_entry += begin.row_entries;
    b.first_motor_entry += begin.motor_entries;
    b.end_motor_entry += begin.motor_entries;
  }
  for (Index& entry : flat.motor_entry) entry += 2 * begin.motors;
  for (Element& e : flat.element)
    e.index += e.kind == ElementKind::joint    ? begin.joints
               : e.kind == ElementKind::spring ? begin.springs
                                               : begin.motors;
  for (Joint& j : flat.joint) {
    j.a.body += first_body;
    j.b.body += first_body;
  }
  for (SpringDamper& s : flat.spring) {
    s.a.body += first_body;
    s.b.body += first_body;
  }
  for (Motor& m : flat.motor) {
    m.a += first_body;
    if (m.b != kWorld) m.b += first_body;
  }
  for (Index& slot : flat.slot_of_body)
    if (slot >= 0) slot += begin.bodies;
  for (auto* rows : {&flat.row_of_joint, &flat.row_of_spring})
    for (Index& row : *rows) row += begin.rows;
  return flat;
}

}  // namespace gonogo::sim
