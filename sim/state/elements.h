// Elements of a batch: force elements, controllers, drivelines and monitors. Each world has its place in the arrays.
#pragma once
#include "base/error.h"
#include "sim/state/driveline.h"
#include "sim/state/monitor.h"

namespace gonogo::sim {

/// Ranges of a world's elements, motors and springs.
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
  Index drivelines = 0;

  bool operator==(const ElementSize&) const = default;
};

inline ElementSize larger(const ElementSize& a, const ElementSize& b) {
  return {.loaded = std::max(a.loaded, b.loaded),
          .forces = std::max(a.forces, b.forces),
          .controllers = std::max(a.controllers, b.controllers),
          .table_points = std::max(a.table_points, b.table_points),
          .monitors = std::max(a.monitors, b.monitors),
          .samples = std::max(a.samples, b.samples),
          .drivelines = std::max(a.drivelines, b.drivelines)};
}

/// Where the elements begin that follow these. Throws InputError when the samples of the batch exceed an Index.
inline ElementSize after(const ElementSize& first, const ElementSize& size) {
  if (size.samples > std::numeric_limits<Index>::max() - first.samples)
    throw InputError("the monitors of the batch record more than 2^31 samples; use a larger stride or fewer worlds");
  return {.loaded = first.loaded + size.loaded,
          .forces = first.forces + size.forces,
          .controllers = first.controllers + size.controllers,
          .table_points = first.table_points + size.table_points,
          .monitors = first.monitors + size.monitors,
          .samples = first.samples + size.samples,
          .drivelines = first.drivelines + size.drivelines};
}

/// Elements of a checked world; all indices count from zero.
struct FlatElements {
  std::vector<TablePoint> table;
  std::vector<ForceElement> force;
  std::vector<LoadedBody> loaded;
  std::vector<ControllerPlan> controller;
  std::vector<DrivelinePlan> driveline;
  std::vector<DrivelineState> driveline_state;
  std::vector<MonitorPlan> monitor;
  std::vector<MonitorState> monitor_state;
  Index sample_capacity = 0;

  ElementSize size() const {
    return {.loaded = Index(loaded.size()),
            .forces = Index(force.size()),
            .controllers = Index(controller.size()),
            .table_points = Index(table.size()),
            .monitors = Index(monitor.size()),
            .samples = sample_capacity,
            .drivelines = Index(driveline.size())};
  }
};

/// Whether a controller or driveline of the world sets this motor of it.
inline bool sets_motor(const FlatElements& f, Index motor) {
  for (const ControllerPlan& c : f.controller)
    if (c.motor == motor) return true;
  for (const DrivelinePlan& d : f.driveline) {
    for (const DrivenAxle& a : d.axle)
      if (a.wheel[0] == motor || a.wheel[1] == motor || a.lock == motor) return true;
    for (const Brake& b : d.brake)
      if (b.motor == motor) return true;
  }
  return false;
}

/// Where a world lies in the arrays of the batch, and how many elements fit there.
struct ElementPlace {
  WorldIndex world = 0;
  BodyIndex body = 0;
  Index motor = 0, motor_count = 0, spring = 0, spring_count = 0;
  ElementSize first, room;
};

/// State of a world's elements between steps.
struct ElementSnapshot {
  WorldStop stop;
  std::vector<ControllerState> controller;
  std::vector<MonitorState> monitor;
  std::vector<MonitorSample> sample;
  std::vector<DrivelineState> driveline;

  bool fits(const ElementSize& size) const {
    return Index(controller.size()) == size.controllers && Index(monitor.size()) == size.monitors &&
           Index(sample.size()) == size.samples && Index(driveline.size()) == size.drivelines;
  }
};

/// The same driveline with the indices of the batch.
inline DrivelinePlan placed(DrivelinePlan d, const ElementPlace& at) {
  d.world = at.world;
  d.body += at.body;
  for (DrivenAxle& a : d.axle)
    for (Index* motor : {&a.wheel[0], &a.wheel[1], &a.lock})
      if (*motor >= 0) *motor += at.motor;
  for (Brake& b : d.brake)
    if (b.motor >= 0) b.motor += at.motor;
  for (Table* t : {&d.torque, &d.torque_ratio, &d.capacity, &d.throttle, &d.braking, &d.speed})
    t->first += at.first.table_points;
  return d;
}

/// The same elements with the indices of the batch; the rest of the place holds none.
inline FlatElements placed(FlatElements f, const ElementPlace& at) {
  for (ForceElement& e : f.force) e.body += at.body;
  for (LoadedBody& l : f.loaded) {
    l.body += at.body;
    l.first += at.first.forces;
    l.end += at.first.forces;
  }
  f.loaded.resize(at.room.loaded);
  for (ControllerPlan& c : f.controller) {
    c.world = at.world;
    c.body += at.body;
    c.motor += at.motor;
    c.command.first += at.first.table_points;
    c.limit.first += at.first.table_points;
  }
  f.controller.resize(at.room.controllers);
  for (DrivelinePlan& d : f.driveline) d = placed(d, at);
  f.driveline.resize(at.room.drivelines);
  for (MonitorPlan& m : f.monitor) {
    m.body += at.body;
    if (m.motor >= 0) m.motor += at.motor;
    m.first_sample += at.first.samples;
  }
  return f;
}

}  // namespace gonogo::sim
