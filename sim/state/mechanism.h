// Joints, springs and motors between two bodies a and b. Positions, angles and speeds are those of a relative to b.
// sim/scene/scene.h makes them from points and axes in the world.
//
// A mechanism: bodies that joints, springs and motors connect; fixed bodies do not connect. In each step its joints and
// implicit springs are rows
//     J v + b = -E p,   v = v_gathered + M^-1 J^T p
// with p their impulses, E the softness of springs and b the bias that removes drift. v_gathered: velocities by free
// motion, contacts and motors. Eliminating p gives the end-of-step velocities as an affine map of the gathered ones:
//     v = P v_gathered + c,   P = I - M^-1 J^T A^-1 J,   c = -M^-1 J^T A^-1 b,   A = J M^-1 J^T + E.
// P M^-1 = M^-1 - M^-1 J^T A^-1 J M^-1 <= M^-1, so contacts' step sizes bounded with M^-1 stay valid.
//
// Inside the iteration a speed motor is a bilateral row with bounded impulse,
//     |p| <= h T,   p < h T => axis . (w_a - w_b) >= speed,   p > -h T => axis . (w_a - w_b) <= speed,
// and takes projected-gradient steps beside the contacts. A torque motor's impulse is h T from the start.
#pragma once
#include "base/parallel/buffer.h"
#include "sim/shape/shape.h"
#include "sim/state/contact.h"
#include "sim/state/iteration.h"

namespace gonogo::sim {

/// The world itself as partner of a motor.
inline constexpr BodyIndex kWorld = -1;

/// Where a joint or spring holds a body.
struct Attachment {
  BodyIndex body = 0;
  Index slot = -1;       // of the body in its mechanism; -1: a fixed body; set by flatten
  Vec3 point_B;          // [m]
  Vec3 axis_B{0, 0, 1};  // unit
  Vec3 side_B{1, 0, 0};  // unit, at right angles to the axis
};

/// What a joint holds. The axis is the attachment's.
///   revolute   the points coincide and the axes are parallel
///   spherical  the points coincide
///   prismatic  all directions are equal and a's point stays on b's axis
///   fixed      the points coincide and all directions are equal
///   distance   the distance of the points
///   universal  the points coincide and the axes are at right angles
///   in_line    a's point stays on b's axis: the last pin of a belt, whose other pins hold the directions
///   equal_spin a and b turn equally fast, each about its own axis: wheels on one shaft, or behind a locked
///   differential
enum class JointType : std::int32_t { revolute, spherical, prismatic, fixed, distance, universal, in_line, equal_spin };

struct Joint {
  JointType type = JointType::fixed;
  Attachment a, b;
  double length = 0;  // of a distance joint [m]
};

/// Number of equations of a joint.
GONOGO_HD inline Index row_count(JointType type) {
  switch (type) {
    case JointType::revolute:
      return 5;
    case JointType::spherical:
      return 3;
    case JointType::prismatic:
      return 5;
    case JointType::fixed:
      return 6;
    case JointType::distance:
      return 1;
    case JointType::universal:
      return 4;
    case JointType::in_line:
      return 2;
    case JointType::equal_spin:
      return 1;
  }
  return 0;
}

/// What a spring measures.
///   linear     distance of the points
///   axial      position of a's point along b's axis
///   torsional  angle about b's axis from b's side to a's side, in (-pi, pi]
enum class SpringKind : std::int32_t { linear, axial, torsional };

inline constexpr int kMaxTablePoints = 32;  // a nonlinear spring and its stops

/// Force over stretch, linear between the points and beyond the ends; stretches ascend, forces never fall.
struct ForceTable {
  std::int32_t count = 0;           // 0: no table
  Real stretch[kMaxTablePoints]{};  // [m] or [rad]
  Real force[kMaxTablePoints]{};    // [N] or [N m]
};

/// Spring and damper, implicit in the step. The force is stiffness * stretch + damping * rate; with a table its force
/// at the stretch, with the tangent at the step's start, replaces the first term.
struct SpringDamper {
  SpringKind kind = SpringKind::linear;
  Attachment a, b;
  double free_length = 0;  // measured when unloaded [m] or [rad]
  Real stiffness = 0;      // [N/m] or [N m/rad]; unused with a table
  Real damping = 0;        // [N s/m] or [N m s/rad]
  ForceTable table;
};

enum class MotorKind : std::int32_t { speed, torque };

/// Torque on body a about an axis fixed in b or in the world, and the opposite torque on b.
struct Motor {
  MotorKind kind = MotorKind::speed;
  BodyIndex a = 0, b = kWorld;
  Index slot_a = -1, slot_b = -1;  // as in Attachment
  Vec3 axis_B{0, 0, 1};            // unit, in b's frame or the world's
  Real target = 0;                 // speed of a relative to b [rad/s], or torque on a [N m]
  Real max_torque = 0;             // of a speed motor [N m]
};

/// Enough for a vehicle with its suspensions, or for the belt of a track, which is a mechanism of its own. The map is
/// dense: its cost per update grows with the square of the number of bodies.
inline constexpr Index kMaxMechanismBodies = 96, kMaxMechanismRows = 480;

/// Sizes are rounded up to a multiple of this, so that eight columns can be computed at once.
inline constexpr Index kColumnBlock = 8;
GONOGO_HD inline Index padded(Index n) {
  GONOGO_ASSERT(n >= 0);
  return (n + kColumnBlock - 1) / kColumnBlock * kColumnBlock;
}

struct Mechanism {
  WorldIndex world = 0;
  Index first_body = 0, body_count = 0;        // into the mechanism bodies
  Index first_element = 0, element_count = 0;  // into the elements
  Index first_row = 0, row_count = 0;          // into the rows
  Index motor_count = 0;                       // its motors are its last elements
  Index system = 0;                            // where its linear system begins
  Index projection = 0;                        // where its affine map begins

  GONOGO_HD Index unknowns() const { return 6 * body_count; }
  /// The system's rows hold A, then J, then b.
  GONOGO_HD Index first_right() const { return padded(row_count); }
  GONOGO_HD Index stride() const { return first_right() + padded(unknowns() + 1); }
  /// The affine map is stored column by column, the last one being c.
  GONOGO_HD Index column_stride() const { return padded(unknowns()); }
  GONOGO_HD Index system_size() const { return row_count * stride(); }
  GONOGO_HD Index projection_size() const { return (unknowns() + 1) * column_stride(); }
};

/// A body of a mechanism and the entries of the rows and motors that act on it. An entry is 2 k + side: k a row of the
/// mechanism or a motor of the batch, side 0 body a.
struct MechanismBody {
  BodyIndex body = 0;
  Index mechanism = 0;
  Index driven = 0;  // 1: the mechanism has motors, see size_motor_steps
  Index first_row_entry = 0, end_row_entry = 0;
  Index first_motor_entry = 0, end_motor_entry = 0;
};

enum class ElementKind : std::int32_t { joint, spring, motor };

/// A joint, spring or motor of a mechanism and the first of its rows there; motors have none.
struct Element {
  ElementKind kind = ElementKind::joint;
  Index index = 0;  // into the joints, springs or motors
  Index row = 0;
};

/// One equation. Side 0 is body a; a 6-vector is linear, then angular, in world axes.
struct Row {
  Index mechanism = 0;
  Index slot[2] = {-1, -1};
  double direction[2][6]{};  // J, scaled to A_ii = 1
  double response[2][6]{};   // M^-1 J^T
  double bias = 0;           // b
  double softness = 0;       // E
};

/// A motor in this step.
struct MotorDrive {
  Vec3 axis_W;
  Real step = 0;  // metric of its projected-gradient update [kg m^2]
};

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

/// The motor's axis in the world.
GONOGO_HD inline Vec3 motor_axis(const Motor& m, View<const Quat> orientation) {
  return m.b == kWorld ? m.axis_B : rotate(orientation[m.b], m.axis_B);
}

/// Speed of a relative to b about the motor's axis [rad/s]. The motors that fill a place of a batch up have no axis: 0.
GONOGO_HD inline Real motor_speed(const Motor& m, const Vec3& axis_W, View<const Velocity> velocity) {
  GONOGO_ASSERT((is_unit(axis_W) || m.max_torque == 0) && m.a != m.b);
  Vec3 w = velocity[m.a].angular;
  if (m.b != kWorld) w -= velocity[m.b].angular;
  return dot(w, axis_W);
}

/// Next impulse on a about the axis [N m s]; `impulse`, `speed`: extrapolated.
GONOGO_HD inline Real updated_motor(const Motor& m, const MotorDrive& drive, Real impulse, Real speed, Real step) {
  GONOGO_ASSERT(step > 0 && m.max_torque >= 0 && (drive.step > 0 || m.max_torque == 0));
  if (m.kind == MotorKind::torque) return m.target * step;
  const Real limit = m.max_torque * step;
  return std::fmin(limit, std::fmax(-limit, impulse - drive.step * (speed - m.target)));
}

/// One accelerated update of a motor.
struct UpdateMotor {
  View<const Motor> motor;
  View<const MotorDrive> drive;
  View<const Velocity> velocity;  // extrapolated
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Real> now, before;  // impulses [N m s]
  Real step;

  GONOGO_HD void operator()(Index i) const {
    const Momentum& iteration = momentum[world_of_body[motor[i].a]];
    if (!iteration.done) update(i, iteration.beta);
  }

  /// In a world that iterates with momentum `beta`.
  GONOGO_HD void update(Index i, Real beta) const {
    const Motor m = motor[i];
    const MotorDrive at = drive[i];
    const Real latest = now[i], from = multiply_add(beta, latest - before[i], latest);
    const Real speed = motor_speed(m, at.axis_W, velocity);
    before[i] = latest;
    now[i] = updated_motor(m, at, from, speed, step);
  }
};

/// Sum of the motors' impulses on a body of a mechanism [N m s].
struct MotorMoment {
  View<const MechanismBody> body;
  View<const Index> motor_entry;
  View<const MotorDrive> drive;
  View<const Real> impulse;

  GONOGO_HD Vec3 operator()(Index k) const {
    GONOGO_ASSERT(body[k].first_motor_entry <= body[k].end_motor_entry);
    Vec3 sum;
    for (Index e = body[k].first_motor_entry; e < body[k].end_motor_entry; ++e) {
      const Index i = motor_entry[e] / 2;
      const Real p = motor_entry[e] % 2 == 0 ? impulse[i] : -impulse[i];
      sum += drive[i].axis_W * p;
    }
    return sum;
  }
};

template <class Exec>
MotorMoment motor_moment(MechanismStore<Exec>& s) {
  return {s.body.view(), s.motor_entry.view(), s.drive.view(), s.motor_impulse.view()};
}

}  // namespace gonogo::sim
