// Joints, springs and motors between two bodies a and b. Positions, angles and speeds are those of a relative to b.
// sim/scene/build_joint.h makes them from points and axes in the world.
#pragma once
#include "sim/shape/shape.h"

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
enum class JointType : std::int32_t { revolute, spherical, prismatic, fixed, distance, universal, in_line };

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

}  // namespace gonogo::sim
