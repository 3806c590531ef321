// Arrays of the elements of a batch: forces, controllers, monitors. Worlds have places, as their bodies do.
#pragma once
#include "base/buffer.h"
#include "sim/element/controller.h"
#include "sim/element/monitor.h"

namespace gonogo::sim {

/// Which elements, motors and springs are a world's.
struct WorldElements {
  Index first_motor = 0, motor_end = 0;
  Index first_spring = 0, spring_end = 0;
  Index first_loaded = 0, loaded_end = 0;
  Index first_monitor = 0, monitor_end = 0;
};

/// How many elements a world has, or where they begin in the batch.
struct ElementSize {
  Index loaded = 0, forces = 0;  // bodies with forces, forces
  Index controllers = 0, table_points = 0;
  Index monitors = 0, samples = 0;

  bool operator==(const ElementSize&) const = default;
};

inline ElementSize larger(const ElementSize& a, const ElementSize& b) {
  return {std::max(a.loaded, b.loaded),           std::max(a.forces, b.forces),
          std::max(a.controllers, b.controllers), std::max(a.table_points, b.table_points),
          std::max(a.monitors, b.monitors),       std::max(a.samples, b.samples)};
}

/// Where the elements behind these begin. Throws InputError when the samples are too many to count.
inline ElementSize after(const ElementSize& first, const ElementSize& size) {
  if (size.samples > std::numeric_limits<Index>::max() - first.samples)
    throw InputError("the monitors of the batch record more than 2^31 samples; use a larger stride or fewer worlds");
  return {first.loaded + size.loaded,           first.forces + size.forces,
          first.controllers + size.controllers, first.table_points + size.table_points,
          first.monitors + size.monitors,       first.samples + size.samples};
}

/// Elements of a checked world; all indices count from zero.
struct FlatElements {
  std::vector<TablePoint> table;
  std::vector<ForceElement> force;
  std::vector<LoadedBody> loaded;
  std::vector<ControllerPlan> controller;
  std::vector<MonitorPlan> monitor;
  std::vector<MonitorState> monitor_state;
  Index sample_capacity = 0;

  ElementSize size() const {
    return {Index(loaded.size()), Index(force.size()),   Index(controller.size()),
            Index(table.size()),  Index(monitor.size()), sample_capacity};
  }
};

/// Where a world lies in the arrays of the batch, and how many elements fit there.
struct ElementPlace {
  WorldIndex world = 0;
  BodyIndex body = 0;
  Index motor = 0, motor_count = 0, spring = 0, spring_count = 0;
  ElementSize first, room;
};

/// What the elements of a world remember from step to step.
struct ElementSnapshot {
  WorldStop stop;
  std::vector<ControllerState> controller;
  std::vector<MonitorState> monitor;
  std::vector<MonitorSample> sample;

  bool fits(const ElementSize& size) const {
    return Index(controller.size()) == size.controllers && Index(monitor.size()) == size.monitors &&
           Index(sample.size()) == size.samples;
  }
};

/// The same elements with the indices of the batch; the rest of the place holds none.
inline FlatElements placed(FlatElements f, const ElementPlace& at) {
  for (ForceElement& e : f.force) e.body += at.body;
  for (LoadedBody& l : f.loaded) l.body += at.body, l.first += at.first.forces, l.end += at.first.forces;
  f.loaded.resize(at.room.loaded);
  for (ControllerPlan& c : f.controller) {
    c.world = at.world;
    c.body += at.body;
    c.motor += at.motor;
    c.command.first += at.first.table_points;
    c.limit.first += at.first.table_points;
  }
  f.controller.resize(at.room.controllers);
  for (MonitorPlan& m : f.monitor) {
    m.body += at.body;
    if (m.motor >= 0) m.motor += at.motor;
    m.first_sample += at.first.samples;
  }
  return f;
}

template <class Exec>
struct ElementState {
  Buffer<WorldElements, Exec> world;
  Buffer<WorldStop, Exec> stop;      // [world]
  Buffer<WorldEnergy, Exec> energy;  // [world] of the latest step
  Buffer<TablePoint, Exec> table;
  Buffer<ForceElement, Exec> force;  // by body
  Buffer<LoadedBody, Exec> loaded;
  Buffer<ForceAndTorque, Exec> applied;  // [loaded] in the latest step
  Buffer<ControllerPlan, Exec> controller;
  Buffer<ControllerState, Exec> controller_state;
  Buffer<MonitorPlan, Exec> monitor;
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
    monitor.fill_zero(total.monitors);
    monitor_state.fill_zero(total.monitors);
    sample.fill_zero(total.samples);
  }

  /// Puts the elements of a world into its place, as they are before its first step.
  void write(const FlatElements& elements, const ElementPlace& at) {
    const ElementSize size = elements.size(), first = at.first;
    const FlatElements f = placed(elements, at);
    table.write(first.table_points, f.table);
    force.write(first.forces, f.force);
    loaded.write(first.loaded, f.loaded);
    controller.write(first.controllers, f.controller);
    monitor.write(first.monitors, f.monitor);
    world.write(at.world,
                WorldElements{at.motor, at.motor + at.motor_count, at.spring, at.spring + at.spring_count, first.loaded,
                              first.loaded + size.loaded, first.monitors, first.monitors + size.monitors});
    restore(
        {{}, std::vector<ControllerState>(size.controllers), f.monitor_state, std::vector<MonitorSample>(size.samples)},
        at);
  }

  ElementSnapshot snapshot(const ElementSize& size, const ElementPlace& at) const {
    return {stop.read(at.world), controller_state.download(at.first.controllers, size.controllers),
            monitor_state.download(at.first.monitors, size.monitors), sample.download(at.first.samples, size.samples)};
  }

  void restore(const ElementSnapshot& from, const ElementPlace& at) {
    stop.write(at.world, from.stop);
    energy.write(at.world, WorldEnergy{});
    controller_state.write(at.first.controllers, from.controller);
    monitor_state.write(at.first.monitors, from.monitor);
    sample.write(at.first.samples, from.sample);
  }
};

}  // namespace gonogo::sim
