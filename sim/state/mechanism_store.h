// Arrays of all mechanisms of a batch; see mechanism.h.
#pragma once
#include "base/buffer.h"
#include "sim/state/mechanism.h"

namespace gonogo::sim {

/// Arrays of all mechanisms of a batch; empty places have no bodies, rows and elements.
template <class Exec>
struct MechanismStore {
  // Set by the host when worlds enter the batch; the motors' targets also by set_motor() and apply_controllers().
  Buffer<Mechanism, Exec> mechanism;
  Buffer<MechanismBody, Exec> body;
  Buffer<Index, Exec> row_entry, motor_entry;  // see MechanismBody
  Buffer<Element, Exec> element;
  Buffer<Joint, Exec> joint;
  Buffer<SpringDamper, Exec> spring;
  Buffer<Motor, Exec> motor;

  // Computed by prepare_mechanisms().
  Buffer<Row, Exec> row;
  Buffer<double, Exec> system;
  Buffer<Real, Exec> projection;
  Buffer<MotorDrive, Exec> drive;  // [motor]

  // Computed by solve().
  Buffer<Velocity, Exec> gathered;   // [mechanism body] before the projection
  Buffer<Real, Exec> motor_impulse;  // [motor], also the next step's warm start [N m s]

  // Computed by recover_impulses(), when somebody asks for loads.
  Buffer<double, Exec> row_impulse;  // [row] p, of the scaled row
};

}  // namespace gonogo::sim
