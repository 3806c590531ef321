// Flattens a world's joints, springs and motors into the arrays of its mechanisms.
#pragma once
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "sim/state/mechanism.h"

namespace gonogo::sim {

/// Sizes of a world's mechanisms, or where they begin in the arrays of a batch.
struct MechanismSize {
  Index mechanisms = 0, bodies = 0, row_entries = 0, motor_entries = 0, elements = 0;
  Index joints = 0, springs = 0, motors = 0, rows = 0, system = 0, projection = 0;

  static constexpr int kParts = 11;
  struct Part {
    const char* name;
    Index MechanismSize::*count;
  };
  static const Part (&parts())[kParts];

  bool operator==(const MechanismSize&) const = default;
};
MechanismSize operator+(const MechanismSize& a, const MechanismSize& b);
/// The larger of each number.
MechanismSize larger(const MechanismSize& a, const MechanismSize& b);

/// All indices count from zero in this world. Joints, springs and motors keep the scene's order.
struct FlatMechanisms {
  std::vector<Mechanism> mechanism;
  std::vector<MechanismBody> body;
  std::vector<Index> row_entry, motor_entry;
  std::vector<Element> element;
  std::vector<Joint> joint;
  std::vector<SpringDamper> spring;
  std::vector<Motor> motor;
  std::vector<Index> slot_of_body;                 // [body of the world] index of its mechanism body, or -1
  std::vector<Index> row_of_joint, row_of_spring;  // first row of each
  Index rows = 0, system = 0, projection = 0;

  MechanismSize size() const;
};

/// Calls f(body index) for every body that a joint, spring or motor names.
template <class F>
void for_each_jointed(SceneWorld& world, const F& f) {
  for (Joint& j : world.joint) {
    f(j.a.body);
    f(j.b.body);
  }
  for (SpringDamper& s : world.spring) {
    f(s.a.body);
    f(s.b.body);
  }
  for (Motor& m : world.motor) {
    f(m.a);
    if (m.b != kWorld) f(m.b);
  }
}

/// Throws InputError, beginning with `where`, for a mechanism beyond kMaxMechanismBodies or kMaxMechanismRows.
FlatMechanisms flatten_mechanisms(const SceneWorld& world, const std::string& where);

/// The same with indices into a batch, where the world's parts begin at `begin` and `first_body`.
FlatMechanisms moved(FlatMechanisms flat, const MechanismSize& begin, WorldIndex world, BodyIndex first_body);

}  // namespace gonogo::sim
