#include "pipeline/trial/drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace gonogo::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

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

/// A drive that is over, read from its monitor.
class Judge {
 public:
  Judge(const TrialSetup& setup, const TrialConditions& conditions, double step, sim::Simulation& simulation,
        sim::WorldIndex world)
      : setup_(setup),
        conditions_(conditions),
        step_(step),
        simulation_(simulation),
        world_(world),
        cause_(simulation.stop(world).cause),
        end_(simulation.monitor(world, 0)) {}

  DriveOutcome outcome() {
    DriveOutcome o = measures();
    std::tie(o.verdict, o.reason) = verdict(o);
    return o;
  }

 private:
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
    const auto back = Index(std::lround(setup_.thresholds.immobile_time / step_));
    return (end_.now.turned - sample(end_.sample_count - 1 - back).turned) * setup_.rig.radius;
  }

  sim::MonitorSample sample(Index i) { return simulation_.samples(world_, 0, i, 1).front(); }

  DriveOutcome measures() {
    DriveOutcome o{};
    o.flags = end_.now.flags;
    o.worst_residual = end_.worst_residual;
    o.energy_error = end_.motor_work > 0 ? end_.energy_gained / end_.motor_work : 0;
    o.drift = end_.now.y;
    o.distance = std::max(0.0, end_.now.x - setup_.run_in_distance);
    // One sample per step; driving begins with the step that ends at park_time.
    const auto parked = Index(std::lround(setup_.park_time / step_));
    const Index first = std::max<Index>(0, parked - 1), driven = end_.sample_count - first;
    if (driven < 4) return o;
    o.drive_time = (end_.now.step - parked) * step_;
    const sim::MonitorMeans half = sim::means_between(sample(first + driven / 2), end_.now, step_);
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
  double step_;  // [s]
  sim::Simulation& simulation_;
  sim::WorldIndex world_;
  sim::StopCause cause_;
  sim::MonitorState end_;
};

}  // namespace

sim::SceneWorld bed_alone(const terrain::Packing& settled, const TrialConditions& conditions) {
  sim::SceneWorld world = terrain::bed_world(settled, conditions.laws, 2 * settled.spec.grain_diameter);
  world.gravity = conditions.gravity;
  return world;
}

Index bed_steps(const TrialSetup& setup, const sim::StepSettings& settings) {
  return std::max(1, int(std::lround(setup.bed_settle_time / settings.step)));
}

TiltedBed tilted_bed(sim::Simulation& simulation, sim::WorldIndex world, std::size_t grain_count) {
  TiltedBed bed;
  const sim::StepReport report = simulation.report(world);
  bed.flags = report.flags;
  bed.residual = report.rms_residual;
  const auto bodies = simulation.bodies(world);
  Vec3d mean;
  for (std::size_t i = 0; i < grain_count; ++i) {
    bed.grain.push_back(bodies[i].position);
    mean += static_cast<Vec3d>(bodies[i].velocity) * (1.0 / double(grain_count));
  }
  bed.creep = std::hypot(mean.x, mean.y);
  return bed;
}

bool fails(const TrialSetup& setup, const TiltedBed& bed) {
  return bed.flags != 0 || bed.creep > setup.thresholds.creep_speed;
}

DriveOutcome outcome_of_failed_bed(const TiltedBed& bed) {
  DriveOutcome o{};
  o.flags = bed.flags;
  o.worst_residual = bed.residual;
  o.bed_creep = bed.creep;
  if (bed.flags == 0) o.verdict = Verdict::no_go, o.reason = Reason::slope_unstable;
  o.slip = o.sinkage = o.drift = o.mean_torque = o.energy_per_metre = kNaN;
  return o;
}

sim::SceneWorld wheel_on_bed(const TrialSetup& setup, const terrain::Packing& settled, const TiltedBed& bed,
                             const TrialConditions& conditions) {
  terrain::Packing packing = settled;
  for (std::size_t i = 0; i < bed.grain.size(); ++i) packing.grain[i].position = bed.grain[i];
  const double x = 0.15 * setup.bed_length, y = 0.5 * setup.bed_width;
  sim::SceneWorld world = terrain::bed_world(packing, conditions.laws, 3 * (setup.rig.radius + setup.rig.lug_height));
  world.gravity = conditions.gravity;
  const auto bodies = vehicle::add_wheel_rig(world, setup.rig, {x, y, resting_axle_height(setup, packing, x, y)},
                                             conditions.payload, terrain::tool_material);
  const double surface =
      terrain::surface_height(packing.grain, setup.bed_length, setup.bed_width, packing.spec.grain_diameter);
  world.controller.push_back(driver(setup, conditions, bodies.motor));
  world.monitor.push_back(wheel_monitor(setup, bodies, surface));
  return world;
}

DriveOutcome judge_drive(const TrialSetup& setup, const TrialConditions& conditions, const TiltedBed& bed, double step,
                         sim::Simulation& simulation, sim::WorldIndex world) {
  DriveOutcome outcome = Judge(setup, conditions, step, simulation, world).outcome();
  outcome.bed_creep = bed.creep;
  outcome.worst_residual = std::max(outcome.worst_residual, bed.residual);
  return outcome;
}

}  // namespace gonogo::pipeline
