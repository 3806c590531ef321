#include "pipeline/trial/drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

#include "pipeline/trial/saved_run.h"

namespace gonogo::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Simulated time between two looks of the host at a running trial [s]. Results do not depend on it.
constexpr double kLookEvery = 0.05;

/// The wheel is let down with its brake on, its rim speed grows from zero to the commanded one, and stays there.
sim::Controller driver(const TrialSetup& setup, const TrialConditions& conditions, Index motor) {
  sim::Controller c;
  c.motor = motor;
  c.command = {{setup.park_time, 0}, {setup.park_time + setup.ramp_time, conditions.speed / setup.rig.radius}};
  c.limit = {{0, setup.rig.max_torque}};
  return c;
}

/// Watches the wheel. Its drop below the height at which the rim would touch the `surface` is the sinkage [m].
sim::Monitor wheel_monitor(const TrialSetup& setup, const vehicle::RigBodies& bodies, double surface) {
  const Thresholds& t = setup.thresholds;
  sim::Monitor m;
  m.body = bodies.wheel;
  m.motor = bodies.motor;
  m.height = surface + setup.rig.radius;
  m.start = setup.park_time;
  m.time_limit = setup.time_limit;
  m.earliest = setup.ramp_time + setup.minimum_drive_time;
  m.distance = setup.run_in_distance + setup.test_distance;
  m.slid_back = t.slid_back_share * setup.rig.vehicle_length;
  m.immobile_window = t.immobile_time;
  m.immobile_from = setup.ramp_time;
  m.immobile_speed = t.immobile_speed;
  return m;
}

class Run {
 public:
  Run(const TrialSetup& setup, const TrialConditions& conditions, const TrialNumerics& numerics,
      const TrialWatch& watch, const sim::SceneWorld& world, std::unique_ptr<sim::Simulation> simulation)
      : setup_(setup),
        conditions_(conditions),
        numerics_(numerics),
        watch_(watch),
        world_(world),
        simulation_(std::move(simulation)) {}

  /// Goes on from where `saved` left it, if it did.
  DriveOutcome until_decided(SavedRun& saved) {
    saved.resume(*simulation_);
    step_ = Index(std::lround(simulation_->report(0).time / numerics_.step));
    show_samples();
    if (step_ == 0) show_frame();
    pass_due_frames();
    while (!stopped()) {
      advance_to_next_look();
      show_samples();
      if (stopped() || step_ >= next_frame()) show_frame();
      if (!stopped()) saved.save_when_due(*simulation_);
    }
    cause_ = simulation_->stop(0).cause;
    end_ = simulation_->monitor(0, 0);
    DriveOutcome o = measures();
    std::tie(o.verdict, o.reason) = verdict(o);
    return o;
  }

 private:
  bool stopped() { return simulation_->stop(0).cause != sim::StopCause::none; }

  /// Step at which the next frame is due.
  Index next_frame() const {
    if (!watch_.frame) return std::numeric_limits<Index>::max();
    return Index(std::min(1e9, std::round(double(frame_count_) * watch_.frame_interval / numerics_.step)));
  }

  /// A world is stepped on after it has stopped until the host looks. Who wants to see it gets the step in which it
  /// stopped: taken again from the look before, which gives the same bits.
  void advance_to_next_look() {
    const auto usual = std::max<Index>(1, Index(std::lround(kLookEvery / numerics_.step)));
    const Index steps = std::max<Index>(1, std::min(usual, next_frame() - step_));
    const sim::Snapshot before = watch_.frame ? simulation_->snapshot(0) : sim::Snapshot{};
    simulation_->advance(steps);
    step_ += steps;
    const Index end = simulation_->stop(0).step;
    if (!watch_.frame || !stopped() || end == step_) return;
    simulation_->restore(0, before);
    simulation_->advance(end - before.steps);
    step_ = end;
  }

  TrialSample seen(const sim::MonitorSample& s) const {
    const double rolled = s.turned * setup_.rig.radius;
    return {s.step * numerics_.step,           s.x,      s.y,        s.drop,          s.speed,
            rolled > 0 ? 1 - s.x / rolled : 0, s.torque, s.residual, s.contact_count, s.iterations};
  }

  /// Gives the observer the samples that it has not seen.
  void show_samples() {
    if (!watch_.sample) return;
    const Index count = simulation_->monitor(0, 0).sample_count - shown_samples_;
    for (const sim::MonitorSample& s : simulation_->samples(0, 0, shown_samples_, count)) watch_.sample(seen(s));
    shown_samples_ += count;
  }

  void show_frame() {
    if (!watch_.frame) return;
    const TrialSample sample = seen(simulation_->monitor(0, 0).now);
    watch_.frame({sample, world_, *simulation_, world_.monitor.front().body});
    pass_due_frames();
  }

  void pass_due_frames() {
    while (next_frame() <= step_) ++frame_count_;
  }

  /// First true line of the contract's verdict table wins.
  std::pair<Verdict, Reason> verdict(const DriveOutcome& o) {
    const Thresholds& t = setup_.thresholds;
    if (cause_ == sim::StopCause::slid_back) return {Verdict::no_go, Reason::slid_back};
    if (cause_ == sim::StopCause::distance) {
      const bool fast = o.mean_speed >= t.go_speed_share * conditions_.speed && o.slip <= t.go_slip;
      return {fast ? Verdict::go : Verdict::slow_go, Reason::none};
    }
    if (cause_ == sim::StopCause::immobile) {
      const bool turning = rolled_in_window() > 0.5 * conditions_.speed * t.immobile_time;
      if (!turning) return {Verdict::no_go, Reason::power};
      if (o.sinkage > setup_.rig.ground_clearance) return {Verdict::no_go, Reason::sinkage};
      return {Verdict::no_go, Reason::traction};
    }
    return {Verdict::no_go, Reason::timeout};
  }

  double rolled_in_window() {
    const auto back = Index(std::lround(setup_.thresholds.immobile_time / numerics_.step));
    return (end_.now.turned - sample(end_.sample_count - 1 - back).turned) * setup_.rig.radius;
  }

  sim::MonitorSample sample(Index i) { return simulation_->samples(0, 0, i, 1).front(); }

  DriveOutcome measures() {
    DriveOutcome o{};
    o.flags = end_.now.flags;
    o.worst_residual = end_.worst_residual;
    o.energy_error = end_.motor_work > 0 ? end_.energy_gained / end_.motor_work : 0;
    o.drift = end_.now.y;
    o.distance = std::max(0.0, end_.now.x - setup_.run_in_distance);
    // One sample per step; driving begins with the step that ends at park_time.
    const auto parked = Index(std::lround(setup_.park_time / numerics_.step));
    const Index first = std::max<Index>(0, parked - 1), driven = end_.sample_count - first;
    if (driven < 4) return o;
    o.drive_time = (end_.now.step - parked) * numerics_.step;
    const sim::MonitorMeans half = sim::means_between(sample(first + driven / 2), end_.now, numerics_.step);
    const double rolled = half.turned * setup_.rig.radius;
    o.mean_speed = half.x / half.time;
    o.slip = rolled > 0 ? 1 - half.x / rolled : kNaN;
    o.sinkage = half.drop;
    o.mean_torque = half.torque;
    o.energy_per_metre = half.x > 0 ? half.work / half.x : kNaN;
    return o;
  }

  const TrialSetup& setup_;
  const TrialConditions& conditions_;
  const TrialNumerics& numerics_;
  const TrialWatch& watch_;
  const sim::SceneWorld& world_;
  std::unique_ptr<sim::Simulation> simulation_;
  sim::StopCause cause_ = sim::StopCause::none;
  sim::MonitorState end_;
  Index step_ = 0, shown_samples_ = 0;
  std::int64_t frame_count_ = 0;
};

/// The bed does not stand by itself, or its simulation went wrong.
bool fails(const TrialSetup& setup, const DriveOutcome& bed) {
  return bed.flags != 0 || bed.bed_creep > setup.thresholds.creep_speed;
}

TrialNumerics numerics_of(const TrialSetup& setup, std::uint64_t attempt) {
  TrialNumerics n = setup.numerics;
  if (attempt > 1) n.step /= 2, n.iterations *= 2;
  return n;
}

/// Lets the bed settle under the trial's gravity with its own laws; returns the moved packing and the bed's mean speed
/// along the slope at the end: a slope that fails by itself keeps accelerating.
terrain::Packing tilted(const TrialSetup& setup, const terrain::Packing& packing, const TrialConditions& conditions,
                        const sim::StepSettings& settings, const TrialWatch& watch, DriveOutcome& outcome) {
  sim::SceneWorld world = terrain::bed_world(packing, conditions.laws, 2 * packing.spec.grain_diameter);
  world.gravity = conditions.gravity;
  const auto simulation = sim::make_simulation(sim::Backend::cpu, {world}, settings, 1);
  simulation->advance(std::max(1, int(std::lround(setup.bed_settle_time / settings.step))));
  outcome.flags = simulation->report(0).flags;
  outcome.worst_residual = simulation->report(0).rms_residual;
  const auto bodies = simulation->bodies(0);
  terrain::Packing result = packing;
  Vec3d mean;
  for (std::size_t i = 0; i < packing.grain.size(); ++i) {
    result.grain[i].position = bodies[i].position;
    mean += static_cast<Vec3d>(bodies[i].velocity) * (1.0 / double(packing.grain.size()));
  }
  outcome.bed_creep = std::hypot(mean.x, mean.y);
  if (watch.frame && fails(setup, outcome))
    watch.frame({{0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, outcome.worst_residual, 0, 0}, world, *simulation, -1});
  return result;
}

/// Height of the axle at which the wheel just clears every grain.
double resting_axle_height(const TrialSetup& setup, const terrain::Packing& packing, double x, double y) {
  const double reach = setup.rig.radius + setup.rig.lug_height;
  double height = packing.surface + reach;
  for (const terrain::Grain& g : packing.grain) {
    const double dx = std::remainder(g.position.x - x, setup.bed_length),
                 dy = std::remainder(g.position.y - y, setup.bed_width);
    const double free = reach + g.radius;
    if (std::fabs(dx) >= free || std::fabs(dy) >= setup.rig.width / 2 + g.radius) continue;
    height = std::max(height, g.position.z + std::sqrt(free * free - dx * dx));
  }
  return height;
}

}  // namespace

DriveOutcome drive(const TrialSetup& setup, const terrain::Packing& settled, const TrialConditions& conditions,
                   std::uint64_t attempt, const TrialWatch& watch, const TrialCheckpoint& checkpoint) {
  const TrialNumerics numerics = numerics_of(setup, attempt);
  const auto settings =
      terrain::bed_step_settings(settled.spec.grain_diameter, numerics.step, numerics.iterations, numerics.tolerance);
  DriveOutcome bed{};
  const terrain::Packing packing = tilted(setup, settled, conditions, settings, watch, bed);
  if (fails(setup, bed)) {
    if (bed.flags == 0) bed.verdict = Verdict::no_go, bed.reason = Reason::slope_unstable;
    bed.distance = bed.drive_time = bed.mean_speed = 0;
    bed.slip = bed.sinkage = bed.drift = bed.mean_torque = bed.energy_per_metre = kNaN;
    return bed;
  }
  const double x = 0.15 * setup.bed_length, y = 0.5 * setup.bed_width;
  sim::SceneWorld world = terrain::bed_world(packing, conditions.laws, 3 * (setup.rig.radius + setup.rig.lug_height));
  world.gravity = conditions.gravity;
  const auto bodies = vehicle::add_wheel_rig(world, setup.rig, {x, y, resting_axle_height(setup, packing, x, y)},
                                             conditions.payload, terrain::tool_material);
  const double surface =
      terrain::surface_height(packing.grain, setup.bed_length, setup.bed_width, packing.spec.grain_diameter);
  world.controller.push_back(driver(setup, conditions, bodies.motor));
  world.monitor.push_back(wheel_monitor(setup, bodies, surface));
  Run run(setup, conditions, numerics, watch, world, sim::make_simulation(sim::Backend::cpu, {world}, settings, 1));
  SavedRun saved(checkpoint, world, settings, attempt);
  DriveOutcome outcome = run.until_decided(saved);
  outcome.bed_creep = bed.bed_creep;
  outcome.worst_residual = std::max(outcome.worst_residual, bed.worst_residual);
  return outcome;
}

}  // namespace gonogo::pipeline
