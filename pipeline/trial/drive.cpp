#include "pipeline/trial/drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

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
      const TrialWatch& watch, const sim::SceneWorld& world, std::unique_ptr<sim::Simulation> simulation,
      const vehicle::RigBodies& bodies)
      : setup_(setup),
        conditions_(conditions),
        numerics_(numerics),
        watch_(watch),
        world_(world),
        simulation_(std::move(simulation)),
        wheel_(bodies.wheel) {}

  DriveOutcome until_decided() {
    show_frame_when_due();
    while (simulation_->stop(0).cause == sim::StopCause::none) {
      simulation_->advance(steps_to_next_look());
      show_samples();
      show_frame_when_due();
    }
    if (shown_step_ < step()) show_frame();
    cause_ = simulation_->stop(0).cause;
    end_ = simulation_->monitor(0, 0);
    DriveOutcome o = measures();
    std::tie(o.verdict, o.reason) = verdict(o);
    return o;
  }

 private:
  Index step() { return Index(std::lround(simulation_->report(0).time / numerics_.step)); }

  /// Steps until the next frame is due, to the nearest step, or until the host has a look.
  Index steps_to_next_look() {
    const auto steps = std::max<Index>(1, Index(std::lround(kLookEvery / numerics_.step)));
    if (!watch_.frame) return steps;
    const double due = double(frame_count_) * watch_.frame_interval;
    return std::clamp<Index>(Index(std::lround(due / numerics_.step)) - step(), 1, steps);
  }

  /// Gives the observer the samples that it has not seen.
  void show_samples() {
    const Index count = simulation_->monitor(0, 0).sample_count - shown_samples_;
    if (count == 0) return;
    for (const sim::MonitorSample& s : simulation_->samples(0, 0, shown_samples_, count)) {
      const double rolled = s.turned * setup_.rig.radius;
      sample_ = {s.step * numerics_.step,
                 s.x,
                 s.y,
                 s.drop,
                 s.speed,
                 rolled > 0 ? 1 - s.x / rolled : 0,
                 s.torque,
                 s.residual,
                 s.contact_count,
                 s.iterations};
      if (watch_.sample) watch_.sample(sample_);
    }
    shown_samples_ += count;
  }

  void show_frame_when_due() {
    if (!watch_.frame) return;
    if (step() * numerics_.step + 0.5 * numerics_.step >= double(frame_count_) * watch_.frame_interval) show_frame();
  }

  void show_frame() {
    if (!watch_.frame) return;
    shown_step_ = step();
    const double time = shown_step_ * numerics_.step;
    while (double(frame_count_) * watch_.frame_interval <= time + 0.5 * numerics_.step) ++frame_count_;
    watch_.frame({sample_, world_, *simulation_, wheel_});
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
  sim::BodyIndex wheel_;
  sim::StopCause cause_ = sim::StopCause::none;
  sim::MonitorState end_;
  TrialSample sample_{};
  Index shown_samples_ = 0, shown_step_ = -1;
  std::int64_t frame_count_ = 0;
};

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
  if (watch.frame && (outcome.flags != 0 || outcome.bed_creep > setup.thresholds.creep_speed))
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
                   const TrialNumerics& numerics, const TrialWatch& watch) {
  const auto settings =
      terrain::bed_step_settings(settled.spec.grain_diameter, numerics.step, numerics.iterations, numerics.tolerance);
  DriveOutcome bed{};
  const terrain::Packing packing = tilted(setup, settled, conditions, settings, watch, bed);
  if (bed.flags != 0 || bed.bed_creep > setup.thresholds.creep_speed) {
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
  Run run(setup, conditions, numerics, watch, world, sim::make_simulation(sim::Backend::cpu, {world}, settings, 1),
          bodies);
  DriveOutcome outcome = run.until_decided();
  outcome.bed_creep = bed.bed_creep;
  outcome.worst_residual = std::max(outcome.worst_residual, bed.worst_residual);
  return outcome;
}

}  // namespace gonogo::pipeline
