// Stages of a step: controllers and drivelines set motors, force elements push bodies.
#pragma once
#include "sim/state/mechanism.h"
#include "sim/state/state.h"

namespace gonogo::sim {

struct ApplyController {
  View<const ControllerPlan> controller;
  View<const TablePoint> table;
  View<const Index> steps;  // [world] taken
  View<const Velocity> velocity;
  View<const Quat> orientation;
  View<ControllerState> state;
  View<Motor> motor;
  Real step;

  GONOGO_HD void operator()(Index i) const {
    const ControllerPlan& c = controller[i];
    if (c.motor < 0) return;
    Motor& m = motor[c.motor];
    const MotorCommand command = command_of(c, m, state[i]);
    GONOGO_ASSERT(!(command.max_torque < 0));
    m.target = Real(command.speed);
    m.max_torque = Real(command.max_torque);
  }

  GONOGO_HD MotorCommand command_of(const ControllerPlan& c, const Motor& m, ControllerState& own) const {
    const double time = double(steps[c.world]) * double(step);
    if (c.type == ControllerType::schedule) return schedule_command(table, c, time);
    if (has_torque_curve(c.type)) {
      const double turns = motor_speed(m, motor_axis(m, orientation), velocity);
      return c.type == ControllerType::throttle ? throttle_command(table, c, time, turns)
                                                : held_speed_command(table, c, time, turns);
    }
    const Vec3 axis = c.frame == ReferenceFrame::body ? rotate(orientation[c.body], c.axis) : c.axis;
    if (sets_angle(c.type)) {
      const ArmPose arm{axis, motor_axis(m, orientation), rotate(orientation[m.a], c.pointer_a)};
      if (c.type == ControllerType::angle) return angle_command(table, c, time, arm);
      return steering_command(table, c, time, arm, double(velocity[c.body].linear.y), step, own);
    }
    return velocity_command(table, c, time, dot(velocity[c.body].linear, axis), step, own);
  }
};

/// Sets the motors of a driveline.
struct ApplyDriveline {
  View<const DrivelinePlan> driveline;
  View<const TablePoint> table;
  View<const Index> steps;  // [world] taken
  View<const Velocity> velocity;
  View<const Quat> orientation;
  View<DrivelineState> state;
  View<Motor> motor;
  Real step;

  GONOGO_HD void operator()(Index i) const {
    const DrivelinePlan& d = driveline[i];
    if (d.world < 0) return;
    DrivelineState& own = state[i];
    const double time = double(steps[d.world]) * double(step);
    GONOGO_ASSERT(d.axle_count >= 1 && d.axle_count <= kMaxDrivenAxles && d.brake_count <= kMaxBrakes);
    const double shaft = shaft_speed(d);
    const Pedals p = pedals(table, d, time, speed_seen(d, shaft), step, own);
    const double torque = gearbox_torque(table, d, p.throttle, shaft, step, own);
    shift(d, time, own);
    for (Index a = 0; a < d.axle_count; ++a) drive(d.axle[a], d.axle[a].share * torque);
    for (Index b = 0; b < d.brake_count; ++b) set(d.brake[b].motor, {0, p.brake * d.brake[b].torque});
  }

  GONOGO_HD void set(Index m, const MotorCommand& command) const {
    motor[m].target = Real(command.speed);
    motor[m].max_torque = Real(command.max_torque);
  }

  GONOGO_HD double speed_seen(const DrivelinePlan& d, double shaft) const {
    if (d.way_per_radian > 0) return d.way_per_radian * shaft;
    return dot(velocity[d.body].linear, rotate(orientation[d.body], d.axis_B));
  }

  GONOGO_HD double speed_of(Index m) const {
    return motor_speed(motor[m], motor_axis(motor[m], orientation), velocity);
  }

  /// Speed behind the gearbox [rad/s]: the axles' speeds weighted by their shares of torque, so that power is
  /// conserved. An axle's speed is the mean of its wheels'.
  GONOGO_HD double shaft_speed(const DrivelinePlan& d) const {
    double sum = 0;
    for (Index a = 0; a < d.axle_count; ++a) {
      const DrivenAxle& axle = d.axle[a];
      const double first = speed_of(axle.wheel[0]);
      sum += axle.share * (axle.wheel[1] < 0 ? first : 0.5 * (first + speed_of(axle.wheel[1])));
    }
    return sum;
  }

  GONOGO_HD void drive(const DrivenAxle& axle, double torque) const {
    if (axle.wheel[1] < 0) {
      set(axle.wheel[0], torque_command(torque));
      return;
    }
    for (const Index wheel : axle.wheel) set(wheel, torque_command(0.5 * torque));
    if (axle.lock >= 0) set(axle.lock, {0, lock_limit(axle, torque)});
  }
};

/// Adds the sum of a body's forces to its free velocity.
struct ApplyForces {
  View<const LoadedBody> loaded;
  View<const ForceElement> force;
  View<const Index> steps;  // [world] taken
  View<const WorldIndex> world_of_body;
  View<const Velocity> velocity;
  View<const Quat> orientation;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  View<ForceAndTorque> applied;
  View<Velocity> velocity_change;
  Real step, substep;  // [s]

  GONOGO_HD void operator()(Index i) const {
    const LoadedBody& l = loaded[i];
    if (l.first == l.end) return;
    GONOGO_ASSERT(l.first < l.end && l.end <= force.size);
    const LoadedMotion motion = motion_of(l.body);
    const double time = double(steps[world_of_body[l.body]]) * double(step);
    ForceAndTorque sum;
    for (Index k = l.first; k < l.end; ++k) {
      const ForceAndTorque w = load_of(force[k], motion, time, step);
      sum.force += w.force;
      sum.torque += w.torque;
    }
    applied[i] = sum;
    velocity_change[l.body].linear += substep * scale(motion.inverse_mass, sum.force);
    velocity_change[l.body].angular += substep * (motion.inverse_inertia_W * sum.torque);
  }

  /// inverse_inertia_W holds nothing for bodies with equal moments of inertia.
  GONOGO_HD LoadedMotion motion_of(BodyIndex b) const {
    const BodyMass& m = mass[b];
    const Real same = m.inverse_inertia_B.x;
    return {orientation[b], velocity[b], m.inverse_mass,
            m.isotropic ? SymMat3{same, same, same, 0, 0, 0} : inverse_inertia_W[b]};
  }
};

/// Sets the motors for the step that begins. Call once it is certain that the step will be completed, because integrals
/// move on.
template <class Exec>
void apply_controllers(Exec exec, State<Exec>& s, const StepSettings& settings) {
  ElementState<Exec>& e = s.element;
  for_each_index(exec, e.controller.size(),
                 ApplyController{.controller = e.controller.view(),
                                 .table = e.table.view(),
                                 .steps = s.steps.view(),
                                 .velocity = s.velocity.view(),
                                 .orientation = s.orientation.view(),
                                 .state = e.controller_state.view(),
                                 .motor = s.mechanisms.motor.view(),
                                 .step = settings.step});
  for_each_index(exec, e.driveline.size(),
                 ApplyDriveline{.driveline = e.driveline.view(),
                                .table = e.table.view(),
                                .steps = s.steps.view(),
                                .velocity = s.velocity.view(),
                                .orientation = s.orientation.view(),
                                .state = e.driveline_state.view(),
                                .motor = s.mechanisms.motor.view(),
                                .step = settings.step});
}

/// Adds forces at the step's start to velocity_change; resistance is implicit. Call after prepare_motion().
template <class Exec>
void apply_force_elements(Exec exec, State<Exec>& s, const StepSettings& settings) {
  ElementState<Exec>& e = s.element;
  for_each_index(exec, e.loaded.size(),
                 ApplyForces{.loaded = e.loaded.view(),
                             .force = e.force.view(),
                             .steps = s.steps.view(),
                             .world_of_body = s.world_of_body.view(),
                             .velocity = s.velocity.view(),
                             .orientation = s.orientation.view(),
                             .mass = s.mass.view(),
                             .inverse_inertia_W = s.inverse_inertia_W.view(),
                             .applied = e.applied.view(),
                             .velocity_change = s.velocity_change.view(),
                             .step = settings.step,
                             .substep = settings.substep()});
}

}  // namespace gonogo::sim
