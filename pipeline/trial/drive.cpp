#include "pipeline/trial/drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "vehicle/model/engine_vehicle.h"
#include "vehicle/model/statics.h"

namespace gonogo::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kHeadroom = 2;  // over a standing vehicle's origin [m]

/// The wheel is let down with its brake on, its rim speed grows from zero to the commanded one, and stays there.
sim::Controller driver(const TrialSetup& setup, const TrialConditions& conditions, Index motor) {
  sim::Controller c;
  c.motor = motor;
  c.command = {{setup.park_time, 0}, {setup.park_time + setup.ramp_time, conditions.speed / setup.rig.radius}};
  c.limit = {{0, setup.rig.max_torque}};
  return c;
}

/// Watches what the trial is judged by: the wheel of a quarter vehicle, the chassis of a whole one.
sim::Monitor stopping_monitor(const TrialSetup& setup, sim::BodyIndex body) {
  const Thresholds& t = setup.thresholds;
  sim::Monitor m;
  m.body = body;
  m.start = setup.park_time;
  m.time_limit = setup.time_limit;
  m.earliest = setup.ramp_time + setup.minimum_drive_time;
  m.distance = setup.run_in_distance + setup.test_distance;
  m.slid_back = t.slid_back_share * setup.vehicle_length();
  m.immobile_window = t.immobile_time;
  m.immobile_from = setup.ramp_time;
  m.immobile_speed = t.immobile_speed;
  return m;
}

/// Height of the axle at which a wheel just clears every grain. `reach`: its radius with lugs [m].
double resting_axle_height(const terrain::Packing& packing, double reach, double width, double x, double y) {
  double height = packing.surface + reach;
  for (const terrain::Grain& g : packing.grain) {
    const double dx = std::remainder(g.position.x - x, packing.spec.length),
                 dy = std::remainder(g.position.y - y, packing.spec.width);
    const double free = reach + g.radius;
    if (std::fabs(dx) >= free || std::fabs(dy) >= width / 2 + g.radius) continue;
    height = std::max(height, g.position.z + std::sqrt(free * free - dx * dx));
  }
  return height;
}

double surface_of(const terrain::Packing& packing) {
  return terrain::surface_height(packing.grain, packing.spec.length, packing.spec.width, packing.spec.grain_diameter);
}

/// The wheel of a quarter vehicle. Its drop below the height at which the rim would touch the surface is the sinkage.
void add_rig(const TrialSetup& setup, const TrialConditions& conditions, const terrain::Packing& packing,
             sim::SceneWorld& world) {
  const vehicle::WheelRig& rig = setup.rig;
  const double x = 0.15 * packing.spec.length, y = 0.5 * packing.spec.width;
  const double height = resting_axle_height(packing, rig.radius + rig.lug_height, rig.width, x, y);
  const auto bodies = vehicle::add_wheel_rig(world, rig, {x, y, height}, conditions.payload, terrain::tool_material);
  world.controller.push_back(driver(setup, conditions, bodies.motor));
  sim::Monitor m = stopping_monitor(setup, bodies.wheel);
  m.motor = bodies.motor;
  m.height = surface_of(packing) + rig.radius;
  world.monitor.push_back(m);
}

/// Height of the vehicle's origin at which none of its wheels touches a grain and one almost does.
double resting_height(const vehicle::Vehicle& v, const terrain::Packing& packing, double x, double y) {
  double height = -1e9;
  for (const vehicle::Station& s : vehicle::stations(v)) {
    const double reach = s.wheel->radius + s.wheel->lug_height;
    const double axle = resting_axle_height(packing, reach, s.wheel->width, x + s.centre.x, y + s.centre.y);
    height = std::max(height, axle - s.centre.z);
  }
  return height;
}

/// A whole vehicle with its brakes on, its chassis watched first and its wheels after it.
void add_whole(const TrialSetup& setup, const TrialConditions& conditions, const terrain::Packing& packing,
               sim::SceneWorld& world) {
  const vehicle::Vehicle v = vehicle::loaded(*setup.whole, conditions.payload);
  const double x = 0.5 * packing.spec.length, y = 0.5 * packing.spec.width;
  auto e = vehicle::add_vehicle(world, v, {x, y, resting_height(v, packing, x, y)}, terrain::tool_material);
  vehicle::DriverOrders orders;
  orders.release = setup.park_time;
  orders.throttle_ramp = setup.ramp_time;
  orders.speed = conditions.speed;
  vehicle::add_drive(world, v, e, orders);
  sim::Monitor chassis = stopping_monitor(setup, e.chassis);
  chassis.least_up = std::cos(setup.thresholds.tilt_deg * std::numbers::pi / 180);
  world.monitor.push_back(chassis);
  const double surface = surface_of(packing);
  for (std::size_t i = 0; i < e.wheel.size(); ++i) {
    sim::Monitor m;
    m.body = e.wheel[i];
    m.motor = e.drive_motor[i];
    m.height = surface + e.station[i].wheel->radius;
    m.start = setup.park_time;
    m.time_limit = setup.time_limit;
    world.monitor.push_back(m);
  }
}

/// A wheel of the vehicle and the monitor that watches it.
struct WatchedWheel {
  std::string name;
  Index monitor = 0;
  double radius = 0;  // [m]
  bool driven = true;
};

std::vector<WatchedWheel> watched_wheels(const TrialSetup& setup) {
  if (!setup.whole) return {{"wheel", 0, setup.rig.radius, true}};
  std::vector<WatchedWheel> wheels;
  for (const vehicle::Station& s : vehicle::stations(*setup.whole))
    wheels.push_back({s.name, Index(wheels.size()) + 1, s.wheel->radius, s.driven});
  return wheels;
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
        wheels_(watched_wheels(setup)),
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
    if (cause_ == sim::StopCause::overturned) return {Verdict::no_go, Reason::rollover};
    if (cause_ == sim::StopCause::slid_back) return {Verdict::no_go, Reason::slid_back};
    if (cause_ == sim::StopCause::distance) {
      const bool fast = o.mean_speed >= t.go_speed_share * conditions_.speed && o.slip <= t.go_slip;
      return {fast ? Verdict::go : Verdict::slow_go, Reason::none};
    }
    if (cause_ == sim::StopCause::immobile) {
      const bool turning = rolled_in_window() > 0.5 * conditions_.speed * t.immobile_time;
      if (!turning) return {Verdict::no_go, Reason::power};
      if (o.sinkage > setup_.clearance()) return {Verdict::no_go, Reason::sinkage};
      return {Verdict::no_go, Reason::traction};
    }
    return {Verdict::no_go, Reason::timeout};
  }

  double rolled_in_window() {
    const auto back = Index(std::lround(setup_.thresholds.immobile_time / step_));
    return mean_over_driven([&](const WatchedWheel& w) {
      return (now(w).turned - sample(w.monitor, end_.sample_count - 1 - back).turned) * w.radius;
    });
  }

  template <class Value>
  double mean_over_driven(Value&& value) const {
    double sum = 0;
    int count = 0;
    for (const WatchedWheel& w : wheels_)
      if (w.driven) sum += value(w), ++count;
    return sum / count;
  }

  sim::MonitorSample now(const WatchedWheel& w) const { return simulation_.monitor(world_, w.monitor).now; }
  sim::MonitorSample sample(Index monitor, Index i) const { return simulation_.samples(world_, monitor, i, 1).front(); }

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
    const sim::MonitorMeans half = sim::means_between(sample(0, first + driven / 2), end_.now, step_);
    double rolled = 0, work = 0, drop = 0, torque = 0, driven_wheels = 0;
    for (const WatchedWheel& w : wheels_) {
      const sim::MonitorMeans of = sim::means_between(sample(w.monitor, first + driven / 2), now(w), step_);
      drop += of.drop / double(wheels_.size());
      if (setup_.whole) o.wheels.push_back(record_of(w, of, half.x));
      if (!w.driven) continue;
      rolled += of.turned * w.radius, work += of.work, torque += of.torque, ++driven_wheels;
    }
    rolled /= driven_wheels;
    o.mean_speed = half.x / half.time;
    o.slip = rolled > 0 ? 1 - half.x / rolled : kNaN;
    o.sinkage = drop;
    o.mean_torque = torque / driven_wheels;
    o.energy_per_metre = half.x > 0 ? work / half.x : kNaN;
    return o;
  }

  static WheelRecord record_of(const WatchedWheel& w, const sim::MonitorMeans& of, double travelled) {
    const double rolled = of.turned * w.radius;
    return {w.name, w.driven && rolled > 0 ? 1 - travelled / rolled : kNaN, of.drop, of.torque};
  }

  const TrialSetup& setup_;
  const TrialConditions& conditions_;
  double step_;  // [s]
  sim::Simulation& simulation_;
  sim::WorldIndex world_;
  std::vector<WatchedWheel> wheels_;
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

sim::SceneWorld vehicle_on_bed(const TrialSetup& setup, const terrain::Packing& settled, const TiltedBed& bed,
                               const TrialConditions& conditions) {
  terrain::Packing packing = settled;
  for (std::size_t i = 0; i < bed.grain.size(); ++i) packing.grain[i].position = bed.grain[i];
  const double headroom =
      setup.whole ? kHeadroom + vehicle::standing_height(*setup.whole) : 3 * (setup.rig.radius + setup.rig.lug_height);
  sim::SceneWorld world = terrain::bed_world(packing, conditions.laws, headroom);
  world.gravity = conditions.gravity;
  if (setup.whole)
    add_whole(setup, conditions, packing, world);
  else
    add_rig(setup, conditions, packing, world);
  return world;
}

namespace {

template <class SampleOf>
SeenWheels mean_of_wheels(const TrialSetup& setup, SampleOf&& sample_of) {
  SeenWheels seen;
  double driven = 0;
  const auto wheels = watched_wheels(setup);
  for (const WatchedWheel& w : wheels) {
    const sim::MonitorSample now = sample_of(w.monitor);
    seen.sinkage += now.drop / double(wheels.size());
    if (!w.driven) continue;
    seen.rolled += now.turned * w.radius, seen.torque += now.torque, ++driven;
  }
  seen.rolled /= driven, seen.torque /= driven;
  return seen;
}

}  // namespace

SeenWheels seen_wheels(const TrialSetup& setup, sim::Simulation& simulation, sim::WorldIndex world) {
  return mean_of_wheels(setup, [&](Index m) { return simulation.monitor(world, m).now; });
}

SeenWheels seen_wheels(const TrialSetup& setup, sim::Simulation& simulation, sim::WorldIndex world, Index sample) {
  return mean_of_wheels(setup, [&](Index m) { return simulation.samples(world, m, sample, 1).front(); });
}

DriveOutcome judge_drive(const TrialSetup& setup, const TrialConditions& conditions, const TiltedBed& bed, double step,
                         sim::Simulation& simulation, sim::WorldIndex world) {
  DriveOutcome outcome = Judge(setup, conditions, step, simulation, world).outcome();
  outcome.bed_creep = bed.creep;
  outcome.worst_residual = std::max(outcome.worst_residual, bed.residual);
  return outcome;
}

}  // namespace gonogo::pipeline
