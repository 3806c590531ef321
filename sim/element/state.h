// Arrays of the elements of a batch: forces, controllers, monitors, and the clock of every world.
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

/// Host description of all elements of a batch; see append_elements.
struct FlatElements {
  std::vector<WorldElements> world;
  std::vector<TablePoint> table;
  std::vector<ForceElement> force;
  std::vector<LoadedBody> loaded;
  std::vector<ControllerPlan> controller;
  std::vector<MonitorPlan> monitor;
  std::vector<MonitorState> monitor_state;
  Index sample_capacity = 0;
};

/// What the elements remember from step to step.
struct ElementSnapshot {
  std::vector<Index> clock;
  std::vector<WorldStop> stop;
  std::vector<ControllerState> controller;
  std::vector<MonitorState> monitor;
  std::vector<MonitorSample> sample;
};

template <class Exec>
struct ElementState {
  Buffer<WorldElements, Exec> world;
  Buffer<Index, Exec> clock;         // [world] steps taken
  Buffer<WorldStop, Exec> stop;      // [world]
  Buffer<WorldEnergy, Exec> energy;  // [world] of the latest step
  Buffer<TablePoint, Exec> table;
  Buffer<ForceElement, Exec> force;  // by body
  Buffer<LoadedBody, Exec> loaded;
  Buffer<Wrench, Exec> applied;  // [loaded] in the latest step
  Buffer<ControllerPlan, Exec> controller;
  Buffer<ControllerState, Exec> controller_state;
  Buffer<MonitorPlan, Exec> monitor;
  Buffer<MonitorState, Exec> monitor_state;
  Buffer<MonitorSample, Exec> sample;  // by monitor: samples 0 .. sample_count - 1 of its capacity are recorded

  void upload(const FlatElements& f) {
    world.upload(f.world);
    table.upload(f.table);
    force.upload(f.force);
    loaded.upload(f.loaded);
    controller.upload(f.controller);
    monitor.upload(f.monitor);
    monitor_state.upload(f.monitor_state);
    clock.fill_zero(f.world.size());
    stop.fill_zero(f.world.size());
    energy.fill_zero(f.world.size());
    applied.fill_zero(f.loaded.size());
    controller_state.fill_zero(f.controller.size());
    sample.fill_zero(f.sample_capacity);
  }

  ElementSnapshot snapshot() const {
    return {clock.download(), stop.download(), controller_state.download(), monitor_state.download(),
            sample.download()};
  }

  bool matches(const ElementSnapshot& p) const {
    return Index(p.clock.size()) == clock.size() && Index(p.stop.size()) == stop.size() &&
           Index(p.controller.size()) == controller_state.size() && Index(p.monitor.size()) == monitor_state.size() &&
           Index(p.sample.size()) == sample.size();
  }

  void restore(const ElementSnapshot& p) {
    clock.upload(p.clock);
    stop.upload(p.stop);
    controller_state.upload(p.controller);
    monitor_state.upload(p.monitor);
    sample.upload(p.sample);
    energy.fill_zero(world.size());
    applied.fill_zero(loaded.size());
  }
};

}  // namespace gonogo::sim
