// Arrays of the elements of a batch; see elements.h. Each world has its place in them.
#pragma once
#include "base/buffer.h"
#include "sim/state/elements.h"

namespace gonogo::sim {

template <class Exec>
struct ElementState {
  // Set by the host when worlds enter the batch.
  Buffer<WorldElements, Exec> world;
  Buffer<TablePoint, Exec> table;
  Buffer<ForceElement, Exec> force;  // by body
  Buffer<LoadedBody, Exec> loaded;
  Buffer<ControllerPlan, Exec> controller;
  Buffer<DrivelinePlan, Exec> driveline;
  Buffer<MonitorPlan, Exec> monitor;

  // Computed by apply_controllers().
  Buffer<ControllerState, Exec> controller_state;
  Buffer<DrivelineState, Exec> driveline_state;

  // Computed by apply_force_elements().
  Buffer<ForceAndTorque, Exec> applied;  // [loaded] in the latest step

  // Computed by finish_step().
  Buffer<WorldEnergy, Exec> energy;  // [world] of the latest step
  Buffer<WorldStop, Exec> stop;      // [world]
  Buffer<MonitorState, Exec> monitor_state;
  Buffer<MonitorSample, Exec> sample;  // by monitor: samples 0 .. sample_count - 1 of its capacity are recorded

  void allocate(Index world_count, const ElementSize& total) {
    world.fill_zero(world_count);
    stop.fill_zero(world_count);
    energy.fill_zero(world_count);
    table.fill_zero(total.table_points);
    force.fill_zero(total.forces);
    loaded.fill_zero(total.loaded);
    applied.fill_zero(total.loaded);
    controller.fill_zero(total.controllers);
    controller_state.fill_zero(total.controllers);
    driveline.upload(std::vector<DrivelinePlan>(total.drivelines));  // of no world
    driveline_state.fill_zero(total.drivelines);
    monitor.fill_zero(total.monitors);
    monitor_state.fill_zero(total.monitors);
    sample.fill_zero(total.samples);
  }

  /// Writes the elements of a world into its place, in their state before the first step.
  void write(const FlatElements& elements, const ElementPlace& at) {
    const ElementSize size = elements.size(), first = at.first;
    const FlatElements f = placed(elements, at);
    table.write(first.table_points, f.table);
    force.write(first.forces, f.force);
    loaded.write(first.loaded, f.loaded);
    controller.write(first.controllers, f.controller);
    driveline.write(first.drivelines, f.driveline);
    monitor.write(first.monitors, f.monitor);
    world.write(at.world, WorldElements{.first_motor = at.motor,
                                        .motor_end = at.motor + at.motor_count,
                                        .first_spring = at.spring,
                                        .spring_end = at.spring + at.spring_count,
                                        .first_loaded = first.loaded,
                                        .loaded_end = first.loaded + size.loaded,
                                        .first_monitor = first.monitors,
                                        .monitor_end = first.monitors + size.monitors});
    restore({{},
             std::vector<ControllerState>(size.controllers),
             f.monitor_state,
             std::vector<MonitorSample>(size.samples),
             f.driveline_state},
            at);
  }

  ElementSnapshot snapshot(const ElementSize& size, const ElementPlace& at) const {
    return {stop.read(at.world), controller_state.download(at.first.controllers, size.controllers),
            monitor_state.download(at.first.monitors, size.monitors), sample.download(at.first.samples, size.samples),
            driveline_state.download(at.first.drivelines, size.drivelines)};
  }

  void restore(const ElementSnapshot& from, const ElementPlace& at) {
    stop.write(at.world, from.stop);
    energy.write(at.world, WorldEnergy{});
    controller_state.write(at.first.controllers, from.controller);
    monitor_state.write(at.first.monitors, from.monitor);
    sample.write(at.first.samples, from.sample);
    driveline_state.write(at.first.drivelines, from.driveline);
  }
};

}  // namespace gonogo::sim
