// Start of a step: the rows of every mechanism at the present positions, their elimination, the affine map of its
// bodies' velocities and the step sizes of its motors. One team of threads per mechanism.
//
// Dense symmetric elimination of a mechanism's rows by a team of threads: [A | J | b] becomes [. | A^-1 J | A^-1 b].
// One pass down factors A = L D L^T and applies it to the right-hand sides, one pass goes up. Zeros between rows of
// bodies that are not connected cost nothing. Rows are scaled to A_ii = 1, so pivots lie between 0 and 1. A row that
// depends on rows before it (a planar four-bar has three such) has a pivot of rounding size; it is left out and gets no
// impulse.
#pragma once
#include "base/parallel/team.h"
#include "sim/constraint/joint_rows.h"
#include "sim/state/mechanism.h"

namespace gonogo::sim {

/// Row-major [row_count x stride]; the first `first_right` columns hold the upper triangle of A.
struct LinearSystem {
  double* number;
  Index rows, stride, first_right;

  GONOGO_HD double* row(Index i) const { return number + std::size_t(i) * stride; }
};

GONOGO_HD_INLINED void subtract(double* __restrict target, const double* __restrict source, double share, Index first,
                                Index end) {
  for (Index c = first; c < end; ++c) target[c] -= share * source[c];
}

/// Columns that a team computes at once: a warp of the GPU.
inline constexpr Index kColumnsAtOnce = 32;

/// Row i -= share(i) * row k for the rows of a range, in the columns from `first_column` on.
template <class Team, class Share>
GONOGO_HD void subtract_row(const Team& team, const LinearSystem& s, Index k, Index first_row, Index end_row,
                            Index first_column, const Share& share) {
  if constexpr (Team::kWholeRows) {
    for (Index i = first_row + team.rank(); i < end_row; i += team.size())
      if (const double x = share(i); x != 0) subtract(s.row(i), s.row(k), x, first_column, s.stride);
  } else {
    // Neighbouring threads take neighbouring columns of one row, so a row whose share is zero, as most are, costs one
    // read.
    const Index side_by_side = team.size() < kColumnsAtOnce ? team.size() : kColumnsAtOnce;
    const Index group = team.rank() / side_by_side, groups = team.size() / side_by_side;
    if (group >= groups) return;
    const Index first = first_column + team.rank() % side_by_side;
    const double* __restrict source = s.row(k);
    for (Index i = first_row + group; i < end_row; i += groups) {
      const double x = share(i);
      if (x == 0) continue;
      double* __restrict target = s.row(i);
      for (Index c = first; c < s.stride; c += side_by_side) target[c] -= x * source[c];
    }
  }
}

/// Rows with smaller pivots are left out. A pivot is the square of the angle between a row and those before it [rad^2].
/// Axes meant to be parallel agree to about 1e-6; a link of a millionth of its neighbours' mass still counts.
inline constexpr double kRedundantPivot = 1e-10;

/// Removes row k from the system, so that its part of the solution is zero.
template <class Team>
GONOGO_HD void leave_out(const Team& team, const LinearSystem& s, Index k) {
  team.sync();  // all have seen the pivot
  for (Index c = s.first_right + team.rank(); c < s.stride; c += team.size()) s.row(k)[c] = 0;
  if (team.rank() == 0) s.row(k)[k] = 1;
}

/// After this, row k of the right-hand side holds d_k times the solution's, with the pivots d_k on the diagonal.
template <class Team>
GONOGO_HD void eliminate(const Team& team, const LinearSystem& s) {
  for (Index k = 0; k < s.rows; ++k) {
    const double* pivot_row = s.row(k);
    const double pivot = pivot_row[k], inverse = 1 / pivot;
    GONOGO_ASSERT(!(pivot > 1 + 1e-6));
    if (pivot <= kRedundantPivot)
      leave_out(team, s, k);
    else
      subtract_row(team, s, k, k + 1, s.rows, k + 1, [&](Index i) { return pivot_row[i] * inverse; });
    team.sync();
  }
  for (Index k = s.rows - 1; k > 0; --k) {
    const double inverse = 1 / s.row(k)[k];
    subtract_row(team, s, k, 0, k, s.first_right, [&](Index i) { return s.row(i)[k] * inverse; });
    team.sync();
  }
}

GONOGO_HD inline double dot6(const double (&a)[6], const double (&b)[6]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

struct PrepareMechanism {
  View<const Mechanism> mechanism;
  View<const MechanismBody> body;
  View<const Index> row_entry;
  View<const Element> element;
  View<const Joint> joint;
  View<const SpringDamper> spring;
  View<const Motor> motor;
  View<Row> row;
  View<double> system;
  View<Real> projection;
  View<MotorDrive> drive;
  View<const WorldParameters> world;
  View<const Vec3d> position;
  View<const Quat> orientation;
  View<const BodyMass> mass;
  View<const Velocity> velocity;
  Real step, substep;

  template <class Team>
  GONOGO_HD void operator()(const Team& team, Index index) const {
    const Mechanism& m = mechanism[index];
    GONOGO_ASSERT(m.row_count >= 0 && m.row_count <= kMaxMechanismRows);
    GONOGO_ASSERT(m.body_count >= 0 && m.body_count <= kMaxMechanismBodies && m.motor_count <= m.element_count);
    GONOGO_ASSERT(m.system + m.system_size() <= system.size && m.projection + m.projection_size() <= projection.size);
    const LinearSystem s{system.data + m.system, m.row_count, m.stride(), m.first_right()};
    place_elements(team, index, m);
    team.sync();
    assemble(team, m, s);
    team.sync();
    eliminate(team, s);
    form_projection(team, m, s);
    team.sync();
    size_motor_steps(team, m);
  }

  template <class Team>
  GONOGO_HD void place_elements(const Team& team, Index index, const Mechanism& m) const {
    for (Index e = team.rank(); e < m.element_count; e += team.size()) {
      const Element& part = element[m.first_element + e];
      if (part.kind == ElementKind::joint) place_joint(m, joint[part.index], index, m.first_row + part.row);
      if (part.kind == ElementKind::spring) place_spring(m, spring[part.index], index, m.first_row + part.row);
      if (part.kind == ElementKind::motor) {
        const Motor& turns = motor[part.index];
        drive[part.index].axis_W = motor_axis(turns, orientation);
      }
    }
  }

  GONOGO_HD Link link(const Mechanism& m, const Attachment& a, const Attachment& b) const {
    return link_between(a, b, position, orientation, world[m.world].period);
  }

  GONOGO_HD void place_joint(const Mechanism& m, const Joint& j, Index index, Index first) const {
    const Link l = link(m, j.a, j.b);
    for (Index k = 0; k < gonogo::sim::row_count(j.type); ++k) {
      const RowGeometry g = joint_row(j.type, l, j.length, k);
      const double inertia = write_row(row[first + k], index, j.a, j.b, g);
      harden(row[first + k], g.error, step);
      normalise(row[first + k], inertia);
    }
  }

  GONOGO_HD void place_spring(const Mechanism& m, const SpringDamper& s, Index index, Index at) const {
    const RowGeometry g = spring_row(s, link(m, s.a, s.b));
    const double inertia = write_row(row[at], index, s.a, s.b, g);
    // Over the substeps the mean stretch is the one midway between the first one's start and the last one's.
    const double stretch = g.error + 0.5 * (double(step) - substep) * rate(row[at], s.a.body, s.b.body);
    soften(row[at], spring_force(s, stretch), s.damping, inertia, substep);
    normalise(row[at], inertia);
  }

  /// J v.
  GONOGO_HD double rate(const Row& r, BodyIndex a, BodyIndex b) const {
    double sum = 0;
    for (int side = 0; side < 2; ++side) {
      const Velocity& v = velocity[side == 0 ? a : b];
      const double speed[6] = {v.linear.x, v.linear.y, v.linear.z, v.angular.x, v.angular.y, v.angular.z};
      for (int k = 0; k < 6; ++k) sum += r.direction[side][k] * speed[k];
    }
    return sum;
  }

  /// Directions and responses; the prescribed motion of a fixed partner becomes the bias. Returns J M^-1 J^T of the
  /// row.
  GONOGO_HD double write_row(Row& r, Index index, const Attachment& a, const Attachment& b,
                             const RowGeometry& g) const {
    r.mechanism = index;
    r.bias = 0;
    return write_side(r, 0, a, g.linear, g.angular_a) + write_side(r, 1, b, -g.linear, g.angular_b);
  }

  GONOGO_HD double write_side(Row& r, Index side, const Attachment& at, const Vec3d& linear,
                              const Vec3d& angular) const {
    r.slot[side] = at.slot;
    const double direction[6] = {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
    double response[6];
    respond(at.body, direction, response);
    for (int k = 0; k < 6; ++k) {
      r.direction[side][k] = direction[k];
      r.response[side][k] = response[k];
    }
    if (at.slot >= 0) return dot6(direction, response);
    const Velocity& v = velocity[at.body];
    r.bias += dot(linear, static_cast<Vec3d>(v.linear)) + dot(angular, static_cast<Vec3d>(v.angular));
    return 0;
  }

  /// M^-1 f of one body.
  GONOGO_HD void respond(BodyIndex b, const double (&f)[6], double (&response)[6]) const {
    const BodyMass& m = mass[b];
    const Vec3d e[3] = {rotate_precisely(orientation[b], {1, 0, 0}), rotate_precisely(orientation[b], {0, 1, 0}),
                        rotate_precisely(orientation[b], {0, 0, 1})};
    const Vec3d turn{f[3], f[4], f[5]};
    const Vec3d w = e[0] * (dot(e[0], turn) * m.inverse_inertia_B.x) +
                    e[1] * (dot(e[1], turn) * m.inverse_inertia_B.y) + e[2] * (dot(e[2], turn) * m.inverse_inertia_B.z);
    const double result[6] = {f[0] * m.inverse_mass.x, f[1] * m.inverse_mass.y, f[2] * m.inverse_mass.z, w.x, w.y, w.z};
    for (int k = 0; k < 6; ++k) response[k] = result[k];
  }

  /// [A | J | b] with A = J M^-1 J^T + E, of which the upper triangle; a row of A has entries where it shares a body.
  template <class Team>
  GONOGO_HD void assemble(const Team& team, const Mechanism& m, const LinearSystem& s) const {
    for (Index cell = team.rank(); cell < s.rows * s.stride; cell += team.size()) s.number[cell] = 0;
    team.sync();
    for (Index i = team.rank(); i < s.rows; i += team.size()) {
      const Row& r = row[m.first_row + i];
      double *left = s.row(i), *right = left + s.first_right;
      for (int side = 0; side < 2; ++side) {
        if (r.slot[side] < 0) continue;
        const MechanismBody& at = body[m.first_body + r.slot[side]];
        for (Index e = at.first_row_entry; e < at.end_row_entry; ++e)
          if (const Index j = row_entry[e] / 2; j >= i) {
            GONOGO_ASSERT(j < s.rows);
            left[j] += dot6(r.response[side], row[m.first_row + j].direction[row_entry[e] % 2]);
          }
        for (int k = 0; k < 6; ++k) right[6 * r.slot[side] + k] = r.direction[side][k];
      }
      left[i] += r.softness;
      right[m.unknowns()] = r.bias;
    }
  }

  /// P and c, one column of one body at a time.
  template <class Team>
  GONOGO_HD void form_projection(const Team& team, const Mechanism& m, const LinearSystem& s) const {
    const Index columns = m.unknowns() + 1;
    for (Index item = team.rank(); item < m.body_count * columns; item += team.size()) {
      const Index slot = item / columns, column = item % columns;
      double sum[6] = {};
      if (column / 6 == slot && column < m.unknowns()) sum[column % 6] = 1;
      const MechanismBody& of = body[m.first_body + slot];
      for (Index k = of.first_row_entry; k < of.end_row_entry; ++k) {
        const Index i = row_entry[k] / 2, side = row_entry[k] % 2;
        GONOGO_ASSERT(i < s.rows && row[m.first_row + i].slot[side] == slot);
        const double share = s.row(i)[s.first_right + column] / s.row(i)[i];
        const double(&response)[6] = row[m.first_row + i].response[side];
        for (int c = 0; c < 6; ++c) sum[c] -= response[c] * share;
      }
      Real* to = projection.data + m.projection + std::size_t(column) * m.column_stride() + 6 * slot;
      for (int c = 0; c < 6; ++c) to[c] = Real(sum[c]);
    }
  }

  /// Entry of a' P M^-1 a for the axes of two motors: the speed that a unit impulse of one gives the other.
  GONOGO_HD double motor_coupling(const Mechanism& m, Index i, Index j) const {
    const Motor &p = motor[i], &q = motor[j];
    double sum = 0;
    for (int side = 0; side < 2; ++side) {
      const Index slot = side == 0 ? q.slot_a : q.slot_b;
      if (slot < 0) continue;
      const Vec3 axis = drive[j].axis_W;
      const double sign = side == 0 ? 1 : -1, turn[6] = {0, 0, 0, sign * axis.x, sign * axis.y, sign * axis.z};
      double response[6];
      respond(body[m.first_body + slot].body, turn, response);
      for (int c = 3; c < 6; ++c) sum += response[c] * relative_spin(m, p, drive[i].axis_W, 6 * slot + c);
    }
    return sum;
  }

  /// Speed about a motor's axis that a unit of one gathered velocity component leaves.
  GONOGO_HD double relative_spin(const Mechanism& m, const Motor& p, const Vec3& axis, Index column) const {
    const Real* from = projection.data + m.projection + std::size_t(column) * m.column_stride();
    const Real a[3] = {axis.x, axis.y, axis.z};
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      if (p.slot_a >= 0) sum += double(a[c]) * from[6 * p.slot_a + 3 + c];
      if (p.slot_b >= 0) sum -= double(a[c]) * from[6 * p.slot_b + 3 + c];
    }
    return sum;
  }

  /// The motors of a mechanism get half of its masses, its contacts the rest. The motors' step sizes follow from the
  /// row sums of their coupling (Gershgorin). The lower bound lets a motor with a blocked joint reach its limit.
  template <class Team>
  GONOGO_HD void size_motor_steps(const Team& team, const Mechanism& m) const {
    const Index first = m.first_element + m.element_count - m.motor_count;
    for (Index k = team.rank(); k < m.motor_count; k += team.size()) {
      const Index i = element[first + k].index;
      GONOGO_ASSERT(element[first + k].kind == ElementKind::motor);
      double sum = 0;
      for (Index other = 0; other < m.motor_count; ++other)
        sum += std::fabs(motor_coupling(m, i, element[first + other].index));
      drive[i].step = Real(1 / (2 * std::fmax(sum, 1e-6 * free_spin(i))));
    }
  }

  /// Speed that a unit impulse of a motor gives unconnected bodies [1/(kg m^2)].
  GONOGO_HD double free_spin(Index i) const {
    const Motor& p = motor[i];
    const Vec3d axis = static_cast<Vec3d>(drive[i].axis_W);
    const double turn[6] = {0, 0, 0, axis.x, axis.y, axis.z};
    double sum = 0, response[6];
    for (const BodyIndex b : {p.a, p.b})
      if (b != kWorld) {
        respond(b, turn, response);
        sum += dot6(turn, response);
      }
    return sum;
  }
};

/// Call while positions and velocities are those of the step's start.
template <class Exec>
void prepare_mechanisms(Exec exec, State<Exec>& s, const StepSettings& settings) {
  MechanismStore<Exec>& m = s.mechanisms;
  for_each_team(exec, m.mechanism.size(),
                PrepareMechanism{.mechanism = m.mechanism.view(),
                                 .body = m.body.view(),
                                 .row_entry = m.row_entry.view(),
                                 .element = m.element.view(),
                                 .joint = m.joint.view(),
                                 .spring = m.spring.view(),
                                 .motor = m.motor.view(),
                                 .row = m.row.view(),
                                 .system = m.system.view(),
                                 .projection = m.projection.view(),
                                 .drive = m.drive.view(),
                                 .world = s.world.view(),
                                 .position = s.position.view(),
                                 .orientation = s.orientation.view(),
                                 .mass = s.mass.view(),
                                 .velocity = s.velocity.view(),
                                 .step = settings.step,
                                 .substep = settings.substep()});
}

}  // namespace gonogo::sim
