// Equations of joints and springs: directions, errors and forces, in the world frame. In double, so that drift is
// measured to the precision of the positions.
#pragma once
#include "sim/state/state.h"
#include "sim/state/world.h"

namespace gonogo::sim {

/// An attachment in the world frame.
struct PlacedAttachment {
  Vec3d arm;         // from the centre of mass to the point [m]
  Vec3d axis, side;  // unit
};

GONOGO_HD inline PlacedAttachment placed(const Attachment& at, const Quat& q) {
  GONOGO_ASSERT(is_unit(q) && is_unit(at.axis_B) && is_unit(at.side_B));
  return {rotate_precisely(q, at.point_B), rotate_precisely(q, at.axis_B), rotate_precisely(q, at.side_B)};
}

/// Two attachments and the vector from b's point to the nearest image of a's.
struct Link {
  PlacedAttachment a, b;
  Vec3d offset;  // [m]
};

GONOGO_HD inline Link link_between(const Attachment& a, const Attachment& b, View<const Vec3d> position,
                                   View<const Quat> orientation, const Vec3d& period) {
  Link l{placed(a, orientation[a.body]), placed(b, orientation[b.body]), {}};
  const Vec3d centres = nearest_image(position[a.body] - position[b.body], period);
  // The offset too: where a period is shorter than the vehicle is wide, arms reach beyond half of it.
  l.offset = nearest_image(centres + l.a.arm - l.b.arm, period);
  return l;
}

/// Row of J and its constraint's error. The linear part acts on a and oppositely on b, along one line through a's
/// point, so that drift never creates angular momentum.
struct RowGeometry {
  Vec3d linear, angular_a, angular_b;
  double error = 0;  // [m] or [rad]
};

/// Row of the rate of (p_a - p_b) . u, for a direction u that turns with b.
GONOGO_HD inline RowGeometry point_row(const Link& link, const Vec3d& u) {
  GONOGO_ASSERT(is_unit(u));
  return {u, cross(link.a.arm, u), -cross(link.b.arm + link.offset, u), dot(link.offset, u)};
}

/// Row of the relative turning rate about u; `angle`: vector of the small rotation of a relative to b.
GONOGO_HD inline RowGeometry angle_row(const Vec3d& u, const Vec3d& angle) { return {{}, u, -u, dot(angle, u)}; }

GONOGO_HD inline Vec3d unit_or(const Vec3d& v, const Vec3d& otherwise) {
  const double size = length(v);
  return size > 1e-12 ? v * (1 / size) : otherwise;
}

/// k-th direction of an attachment: axis, side, and the one at right angles to both.
GONOGO_HD inline Vec3d direction_of(const PlacedAttachment& at, Index k) {
  return k == 0 ? at.axis : k == 1 ? at.side : cross(at.axis, at.side);
}

/// Small rotation from the directions of b to those of a: half the sum of e_b x e_a.
GONOGO_HD inline Vec3d small_rotation(const Link& link) {
  Vec3d sum;
  for (Index k = 0; k < 3; ++k) sum += cross(direction_of(link.b, k), direction_of(link.a, k));
  return 0.5 * sum;
}

GONOGO_HD inline RowGeometry distance_row(const Link& link, double free_length) {
  RowGeometry row = point_row(link, unit_or(link.offset, {0, 0, 1}));
  row.error -= free_length;
  return row;
}

/// Row `k` of a joint, 0 <= k < row_count(type).
GONOGO_HD inline RowGeometry joint_row(JointType type, const Link& link, double joint_length, Index k) {
  GONOGO_ASSERT(k >= 0 && k < row_count(type));
  const bool holds_point = type != JointType::prismatic && type != JointType::distance && type != JointType::in_line &&
                           type != JointType::equal_spin;
  if (holds_point && k < 3) return point_row(link, direction_of(link.b, k));
  switch (type) {
    case JointType::revolute:
      return angle_row(direction_of(link.b, k - 2), cross(link.b.axis, link.a.axis));
    case JointType::prismatic:
      return k < 2 ? point_row(link, direction_of(link.b, k + 1))
                   : angle_row(direction_of(link.b, k - 2), small_rotation(link));
    case JointType::fixed:
      return angle_row(direction_of(link.b, k - 3), small_rotation(link));
    case JointType::in_line:
      return point_row(link, direction_of(link.b, k + 1));
    case JointType::universal: {
      const Vec3d u = unit_or(cross(link.a.axis, link.b.axis), link.b.side);
      return {{}, u, -u, dot(link.a.axis, link.b.axis)};
    }
    case JointType::equal_spin:
      return {{}, link.a.axis, -link.b.axis, 0};  // holds speeds, so there is no drift
    default:
      return distance_row(link, joint_length);
  }
}

/// Direction of a spring, and its stretch as the error.
GONOGO_HD inline RowGeometry spring_row(const SpringDamper& s, const Link& link) {
  if (s.kind == SpringKind::linear) return distance_row(link, s.free_length);
  const Vec3d& axis = link.b.axis;
  RowGeometry row;
  if (s.kind == SpringKind::axial) {
    row = point_row(link, axis);
  } else {
    row = angle_row(axis, {});
    row.error = std::atan2(dot(cross(link.b.side, link.a.side), axis), dot(link.b.side, link.a.side));
  }
  row.error -= s.free_length;
  return row;
}

/// Force of a spring at rest [N, N m] and its tangent stiffness.
struct SpringForce {
  double force, stiffness;
};

GONOGO_HD inline SpringForce spring_force(const SpringDamper& s, double stretch) {
  const ForceTable& t = s.table;
  if (t.count == 0) return {double(s.stiffness) * stretch, double(s.stiffness)};
  GONOGO_ASSERT(t.count >= 2 && t.count <= kMaxTablePoints);
  Index k = 0;
  while (k + 2 < t.count && stretch >= double(t.stretch[k + 1])) ++k;
  const double slope = (double(t.force[k + 1]) - t.force[k]) / (double(t.stretch[k + 1]) - t.stretch[k]);
  return {double(t.force[k]) + slope * (stretch - t.stretch[k]), slope};
}

/// Energy of a spring beyond that at zero stretch [J].
GONOGO_HD inline double spring_energy(const SpringDamper& s, double stretch) {
  const ForceTable& t = s.table;
  if (t.count == 0) return 0.5 * s.stiffness * stretch * stretch;
  // Integral of the force from the table's first point.
  const auto work = [&](double to) {
    double sum = 0;
    Index k = 0;
    for (; k + 2 < t.count && to >= double(t.stretch[k + 1]); ++k)
      sum += 0.5 * (double(t.force[k]) + t.force[k + 1]) * (double(t.stretch[k + 1]) - t.stretch[k]);
    return sum + 0.5 * (t.force[k] + spring_force(s, to).force) * (to - t.stretch[k]);
  };
  return work(stretch) - work(0);
}

/// Smaller drift is not corrected: it is the rounding of single-precision orientations at arms of some metres.
inline constexpr double kDriftTolerance = 1e-6;  // [m] or [rad]
/// Max speed at which a joint removes drift.
inline constexpr double kMaxDriftSpeed = 2;  // [m/s] or [rad/s]
/// Bounds on a spring's resistance times its inverse mass; below the first it acts as a force alone.
inline constexpr double kWeakestSpring = 1e-9, kStiffestSpring = 1e9;

/// Speed that removes the whole drift in one step, as one Newton step of SHAKE does (Ryckaert, Ciccotti, Berendsen
/// 1977). That keeps the energy of a swinging mechanism. Correcting only a share would leave a drift of
/// (w h)^2 r / (2 share).
GONOGO_HD inline double drift_bias(double error, double step) {
  GONOGO_ASSERT(step > 0);
  const double beyond = std::fmax(0.0, std::fabs(error) - kDriftTolerance);
  return std::copysign(std::fmin(beyond / step, kMaxDriftSpeed), error);
}

/// Bias of a row without softness.
GONOGO_HD inline void harden(Row& row, double error, double step) {
  row.bias += drift_bias(error, step);
  row.softness = 0;
}

/// Bias and softness of a spring with force f, stiffness k, damping c at the end of the step:
///   p = -h (f + (h k + c) u)   <=>   u + f / (h k + c) = -p / (h (h k + c)),   u = J v;   `inertia` is J M^-1 J^T.
GONOGO_HD inline void soften(Row& row, const SpringForce& spring, double damping, double inertia, double step) {
  GONOGO_ASSERT(step > 0 && !(damping < 0) && !(inertia < 0));
  const double scale = inertia > 0 ? inertia : 1;
  const double resistance = step * (step * spring.stiffness + damping) * scale;
  row.softness = scale / std::fmin(std::fmax(resistance, kWeakestSpring), kStiffestSpring);
  GONOGO_ASSERT(!(row.softness <= 0));
  row.bias += spring.force * step * row.softness;
}

/// Scales a row to A_ii = 1, so that a pivot measures how far the row is from depending on rows before it. A row that
/// can move nothing stays zero.
GONOGO_HD inline void normalise(Row& row, double inertia) {
  const double diagonal = inertia + row.softness;
  GONOGO_ASSERT(!(diagonal < 0));
  const double scale = diagonal > 0 ? 1 / std::sqrt(diagonal) : 0;
  for (int side = 0; side < 2; ++side)
    for (int k = 0; k < 6; ++k) {
      row.direction[side][k] *= scale;
      row.response[side][k] *= scale;
    }
  row.bias *= scale;
  row.softness *= scale * scale;
}

}  // namespace gonogo::sim
