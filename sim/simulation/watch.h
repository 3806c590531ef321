// The last stage of a step: energies, monitors and stop rules of every world.
#pragma once
#include "sim/constraint/joint_rows.h"
#include "sim/state/mechanism.h"
#include "sim/state/world.h"

namespace gonogo::sim {

/// Energy of the springs, and power of motors and forces in the last substep. The order is fixed, so any number of
/// threads gives the same bits.
struct MeasureElements {
  View<const WorldElements> world;
  View<const WorldParameters> parameters;
  View<const Motor> motor;
  View<const MotorDrive> drive;
  View<const Real> motor_impulse;
  View<const SpringDamper> spring;
  View<const LoadedBody> loaded;
  View<const ForceAndTorque> applied;
  View<const Vec3d> position;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<WorldEnergy> energy;
  Real substep;

  GONOGO_HD void operator()(WorldIndex w) const {
    const WorldElements& of = world[w];
    GONOGO_ASSERT(of.first_motor <= of.motor_end && of.first_spring <= of.spring_end &&
                  of.first_loaded <= of.loaded_end);
    WorldEnergy e;
    for (Index i = of.first_motor; i < of.motor_end; ++i)
      e.motor_power += double(motor_impulse[i]) / substep * motor_speed(motor[i], drive[i].axis_W, velocity);
    for (Index i = of.first_spring; i < of.spring_end; ++i) {
      const SpringDamper& s = spring[i];
      const Link link = link_between(s.a, s.b, position, orientation, parameters[w].period);
      e.spring += spring_energy(s, spring_row(s, link).error);
    }
    for (Index i = of.first_loaded; i < of.loaded_end; ++i) {
      const Velocity& v = velocity[loaded[i].body];
      e.force_power += double(dot(applied[i].force, v.linear)) + double(dot(applied[i].torque, v.angular));
    }
    energy[w] = e;
  }
};

/// Adds the step to the monitors of a world that has not stopped, and applies their stop rules.
struct UpdateMonitors {
  View<const WorldElements> element;
  View<const WorldParameters> world;
  View<const WorldSums> sums;
  View<const WorldEnergy> energy;
  View<const Index> flags;
  View<const Motor> motor;
  View<const MotorDrive> drive;
  View<const Real> motor_impulse;
  View<const Vec3d> position;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<const MonitorPlan> monitor;
  View<const Index> steps;  // [world] taken before this one
  View<WorldStop> stop;
  View<MonitorState> state;
  View<MonitorSample> sample;
  Real step, substep;

  GONOGO_HD void operator()(WorldIndex w) const {
    if (stop[w].cause != StopCause::none) return;
    const WatchedStep of_world = watched_world(w);
    StopCause cause = StopCause::none;
    const WorldElements& of = element[w];
    for (Index i = of.first_monitor; i < of.monitor_end; ++i) {
      const WatchedStep now = watched(i, w, of_world);
      add_step(state[i], now, step);
      record(monitor[i], state[i]);
      if (cause != StopCause::none) continue;
      cause = stop_cause(monitor[i], state[i], now.up, sample);
      if (cause != StopCause::none) stop[w] = {cause, i - of.first_monitor, of_world.step};
    }
  }

  GONOGO_HD WatchedStep watched_world(WorldIndex w) const {
    WatchedStep s;
    s.energy = sums[w].kinetic + energy[w].spring;
    const double gravity = sums[w].gravity_power, motors = energy[w].motor_power, forces = energy[w].force_power;
    s.supplied = (gravity + motors + forces) * step;
    s.exchanged = (std::fabs(gravity) + std::fabs(motors) + std::fabs(forces)) * step;
    s.residual = rms_residual(sums[w]);
    s.step = steps[w] + 1;
    s.contact_count = sums[w].contact_count;
    s.iterations = sums[w].iterations;
    s.flags = flags[w];
    return s;
  }

  /// Adds the monitor's body and motor to `s`, and stores the body's position.
  GONOGO_HD WatchedStep watched(Index i, WorldIndex w, WatchedStep s) const {
    const MonitorPlan& p = monitor[i];
    const Vec3d x = position[p.body], moved = x - state[i].position;
    s.moved = nearest_image(moved, world[w].period);
    s.drop = p.height - x.z;
    s.speed = velocity[p.body].linear.x;
    s.up = rotate(orientation[p.body], p.up_B).z;
    if (p.motor >= 0) {
      s.motor_speed = motor_speed(motor[p.motor], drive[p.motor].axis_W, velocity);
      s.torque = double(motor_impulse[p.motor]) / substep;
    }
    state[i].position = x;
    return s;
  }

  /// The record cannot overflow: the time limit stops the world first.
  GONOGO_HD void record(const MonitorPlan& p, MonitorState& m) const {
    if (m.now.step % p.stride != 0 || m.sample_count >= p.capacity) return;
    GONOGO_ASSERT(m.sample_count == m.now.step / p.stride - 1);
    sample[p.first_sample + m.sample_count] = m.now;
    ++m.sample_count;
  }
};

/// Ends the step of a world: elements, monitors, then its clock.
struct FinishStep {
  MeasureElements measure;
  UpdateMonitors monitors;
  View<Index> steps, slowed, slowed_now;  // [world]
  View<Progress> progress;

  GONOGO_HD void operator()(WorldIndex w) const {
    const Index more = slowed_now[w];
    measure(w);
    monitors(w);
    if (more > 0) {
      slowed[w] += more;
      slowed_now[w] = 0;
    }
    ++steps[w];
    if (w == 0) ++progress[0].steps;
  }
};

template <class Exec>
MeasureElements element_measure(State<Exec>& s, const StepSettings& settings) {
  ElementState<Exec>& e = s.element;
  MechanismStore<Exec>& m = s.mechanisms;
  return {.world = e.world.view(),
          .parameters = s.world.view(),
          .motor = m.motor.view(),
          .drive = m.drive.view(),
          .motor_impulse = m.motor_impulse.view(),
          .spring = m.spring.view(),
          .loaded = e.loaded.view(),
          .applied = e.applied.view(),
          .position = s.position.view(),
          .orientation = s.orientation.view(),
          .velocity = s.velocity.view(),
          .energy = e.energy.view(),
          .substep = settings.substep()};
}

template <class Exec>
UpdateMonitors monitor_update(State<Exec>& s, const StepSettings& settings) {
  ElementState<Exec>& e = s.element;
  MechanismStore<Exec>& m = s.mechanisms;
  return {.element = e.world.view(),
          .world = s.world.view(),
          .sums = s.world_sums.view(),
          .energy = e.energy.view(),
          .flags = s.flags.view(),
          .motor = m.motor.view(),
          .drive = m.drive.view(),
          .motor_impulse = m.motor_impulse.view(),
          .position = s.position.view(),
          .orientation = s.orientation.view(),
          .velocity = s.velocity.view(),
          .monitor = e.monitor.view(),
          .steps = s.steps.view(),
          .stop = e.stop.view(),
          .state = e.monitor_state.view(),
          .sample = e.sample.view(),
          .step = settings.step,
          .substep = settings.substep()};
}

/// Call after the positions have been integrated.
template <class Exec>
void finish_step(Exec exec, State<Exec>& s, const StepSettings& settings) {
  for_each_index(exec, s.world_count,
                 FinishStep{element_measure(s, settings), monitor_update(s, settings), s.steps.view(), s.slowed.view(),
                            s.slowed_now.view(), s.progress.view()});
}

}  // namespace gonogo::sim
