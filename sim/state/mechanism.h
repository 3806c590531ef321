// A mechanism: bodies that joints, springs and motors connect; fixed bodies do not connect. In each step its joints and
// implicit springs are rows
//     J v + b = -E p,   v = v_gathered + M^-1 J^T p
// with p their impulses, E the softness of springs and b the bias that removes drift. v_gathered: velocities by free
// motion, contacts and motors. Eliminating p gives the end-of-step velocities as an affine map of the gathered ones:
//     v = P v_gathered + c,   P = I - M^-1 J^T A^-1 J,   c = -M^-1 J^T A^-1 b,   A = J M^-1 J^T + E.
// P M^-1 = M^-1 - M^-1 J^T A^-1 J M^-1 <= M^-1, so contacts' step sizes bounded with M^-1 stay valid.
#pragma once
#include "sim/state/contact.h"
#include "sim/state/joint.h"

namespace gonogo::sim {

/// Enough for a vehicle with its suspensions, or for the belt of a track, which is a mechanism of its own. The map is
/// dense: its cost per update grows with the square of the number of bodies.
inline constexpr Index kMaxMechanismBodies = 96, kMaxMechanismRows = 480;

/// Sizes are rounded up to a multiple of this, so that eight columns can be computed at once.
inline constexpr Index kColumnBlock = 8;
GONOGO_HD inline Index padded(Index n) { return (n + kColumnBlock - 1) / kColumnBlock * kColumnBlock; }

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

}  // namespace gonogo::sim
