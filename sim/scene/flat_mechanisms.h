// Flattens a world's joints, springs and motors into the arrays of its mechanisms, and writes those of a batch.
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

  bool operator==(const MechanismSize&) const = default;
};
/// The numbers of a MechanismSize, with their names in messages.
struct MechanismPart {
  const char* name;
  Index MechanismSize::*count;
};
inline constexpr MechanismPart kMechanismParts[] = {{"mechanisms", &MechanismSize::mechanisms},
                                                    {"jointed bodies", &MechanismSize::bodies},
                                                    {"equations on bodies", &MechanismSize::row_entries},
                                                    {"motors on bodies", &MechanismSize::motor_entries},
                                                    {"joints, springs and motors", &MechanismSize::elements},
                                                    {"joints", &MechanismSize::joints},
                                                    {"springs", &MechanismSize::springs},
                                                    {"motors", &MechanismSize::motors},
                                                    {"joint equations", &MechanismSize::rows},
                                                    {"numbers of joint equations", &MechanismSize::system},
                                                    {"numbers of joint projections", &MechanismSize::projection}};
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

template <class Exec>
void allocate(MechanismStore<Exec>& s, const MechanismSize& total) {
  s.mechanism.fill_zero(total.mechanisms);
  s.body.fill_zero(total.bodies);
  s.gathered.fill_zero(total.bodies);
  s.row_entry.fill_zero(total.row_entries);
  s.motor_entry.fill_zero(total.motor_entries);
  s.element.fill_zero(total.elements);
  s.joint.fill_zero(total.joints);
  s.spring.fill_zero(total.springs);
  s.motor.fill_zero(total.motors);
  s.motor_impulse.fill_zero(total.motors);
  s.drive.fill_zero(total.motors);
  s.row.fill_zero(total.rows);
  s.row_impulse.fill_zero(total.rows);
  s.system.fill_zero(total.system);
  s.projection.fill_zero(total.projection);
}

/// Writes a world's mechanisms, already moved(), into its place and empties the rest of it.
template <class Exec>
void write_mechanisms(MechanismStore<Exec>& s, FlatMechanisms flat, const MechanismSize& begin,
                      const MechanismSize& room) {
  GONOGO_ASSERT(larger(flat.size(), room) == room);
  flat.mechanism.resize(room.mechanisms);
  s.mechanism.write(begin.mechanisms, flat.mechanism);
  s.body.write(begin.bodies, flat.body);
  s.row_entry.write(begin.row_entries, flat.row_entry);
  s.motor_entry.write(begin.motor_entries, flat.motor_entry);
  s.element.write(begin.elements, flat.element);
  s.joint.write(begin.joints, flat.joint);
  s.spring.write(begin.springs, flat.spring);
  flat.motor.resize(room.motors);
  s.motor.write(begin.motors, flat.motor);
  s.motor_impulse.write(begin.motors, std::vector<Real>(room.motors));
}

}  // namespace gonogo::sim
