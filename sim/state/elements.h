// Elements of a batch: force elements, controllers, drivelines and monitors. Each world has its place in the arrays.
#pragma once
#include "base/error.h"
#include "base/parallel/buffer.h"
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

/// The numbers of an ElementSize, with their names in messages.
struct ElementPart {
  const char* name;
  Index ElementSize::*count;
};
inline constexpr ElementPart kElementParts[] = {
    {"bodies with forces", &ElementSize::loaded},  {"forces", &ElementSize::forces},
    {"controllers", &ElementSize::controllers},    {"drivelines", &ElementSize::drivelines},
    {"table points", &ElementSize::table_points},  {"monitors", &ElementSize::monitors},
    {"samples of monitors", &ElementSize::samples}};

inline ElementSize larger(const ElementSize& a, const ElementSize& b) {
  ElementSize max;
  for (const ElementPart& part : kElementParts) max.*part.count = std::max(a.*part.count, b.*part.count);
  return max;
}

/// Where the elements begin that follow these. Throws InputError when the samples of the batch exceed an Index.
inline ElementSize after(const ElementSize& first, const ElementSize& size) {
  if (size.samples > std::numeric_limits<Index>::max() - first.samples)
    throw InputError("the monitors of the batch record more than 2^31 samples; use a larger stride or fewer worlds");
  ElementSize next;
  for (const ElementPart& part : kElementParts) next.*part.count = first.*part.count + size.*part.count;
  return next;
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
  GONOGO_ASSERT(larger(f.size(), at.room) == at.room);
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
    GONOGO_ASSERT(at.world >= 0 && at.world < stop.size());
    stop.write(at.world, from.stop);
    energy.write(at.world, WorldEnergy{});
    controller_state.write(at.first.controllers, from.controller);
    monitor_state.write(at.first.monitors, from.monitor);
    sample.write(at.first.samples, from.sample);
    driveline_state.write(at.first.drivelines, from.driveline);
  }
};

}  // namespace gonogo::sim
