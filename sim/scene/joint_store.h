// Uploads mechanisms into the arrays of a batch.
#pragma once
#include "sim/scene/flatten.h"
#include "sim/state/mechanism_store.h"

namespace gonogo::sim {

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
