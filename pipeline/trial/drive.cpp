#include "pipeline/trial/drive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

namespace gonogo::pipeline {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Energy supplied and gained over a run. What the world gains beyond gravity's and the motor's work is an error of the
/// time stepping; contacts can only take energy away.
struct EnergyBalance {
  double last = 0, gained = 0, motor_work = 0;
  bool started = false;

  void add(double energy, double supplied, double by_motor) {
    if (started) gained += std::max(0.0, energy - last - supplied);
    motor_work += std::max(0.0, by_motor);
    last = energy;
    started = true;
  }
};

/// One sample per step of the driving phase, enough for every measure.
struct Sample {
  double time, x, rolled, sinkage, torque, motor_power;
};

class Run {
 public:
  Run(const TrialSetup& setup, const TrialConditions& conditions, const TrialNumerics& numerics,
      const TrialWatch& watch, double surface, const sim::SceneWorld& world,
      std::unique_ptr<sim::Simulation> simulation, const vehicle::RigBodies& bodies)
      : setup_(setup),
        conditions_(conditions),
        numerics_(numerics),
        watch_(watch),
        surface_(surface),
        world_(world),
        simulation_(std::move(simulation)),
        bodies_(bodies),
        last_(simulation_->body(0, bodies.wheel).position) {}

  /// Lets the wheel down, ramps its speed up and drives until a stop rule holds.
  DriveOutcome until_decided() {
    show_when_due();
    while (time_ < setup_.park_time) step(0);
    while (!decided()) step(std::min(1.0, drive_time() / setup_.ramp_time));
    if (shown_time_ < time_) show();
    return outcome();
  }

 private:
  double drive_time() const { return time_ - setup_.park_time; }

  void step(double speed_share) {
    const double rim_speed = speed_share * conditions_.speed;
    simulation_->set_motor(0, bodies_.motor, Real(rim_speed / setup_.rig.radius), Real(setup_.rig.max_torque));
    simulation_->advance(1);
    time_ += numerics_.step;
    record(simulation_->report(0), simulation_->body(0, bodies_.wheel), simulation_->body(0, bodies_.sprung));
    show_when_due();
  }

  /// Frames are due at multiples of the interval, to the nearest step.
  void show_when_due() {
    if (time_ + 0.5 * numerics_.step >= double(frame_count_) * watch_.frame_interval) show();
  }

  void show() {
    shown_time_ = time_;
    while (double(frame_count_) * watch_.frame_interval <= time_ + 0.5 * numerics_.step) ++frame_count_;
    if (watch_.frame) watch_.frame({sample_, world_, *simulation_, bodies_.wheel});
  }

  void record(const sim::StepReport& report, const sim::BodyState& wheel, const sim::BodyState& sprung) {
    x_ += periodic_change(wheel.position.x - last_.x, setup_.bed_length);
    y_ += periodic_change(wheel.position.y - last_.y, setup_.bed_width);
    last_ = wheel.position;
    rolled_ += wheel.angular_velocity.y * numerics_.step * setup_.rig.radius;
    flags_ = report.flags;
    worst_residual_ = std::max(worst_residual_, report.rms_residual);
    const double stretch = sprung.position.z - wheel.position.z - 1.0;
    const double energy = report.kinetic_energy + 0.5 * setup_.rig.spring_stiffness * stretch * stretch;
    energy_.add(energy, (report.gravity_power + report.motor_power) * numerics_.step,
                report.motor_power * numerics_.step);
    if (drive_time() >= 0)
      samples_.push_back({drive_time(), x_, rolled_, surface_ - (wheel.position.z - setup_.rig.radius),
                          simulation_->motor_torque(0, bodies_.motor), report.motor_power});
    sample_ = {time_,
               x_,
               y_,
               surface_ - (wheel.position.z - setup_.rig.radius),
               wheel.velocity.x,
               rolled_ > 0 ? 1 - x_ / rolled_ : 0,
               simulation_->motor_torque(0, bodies_.motor),
               report.rms_residual,
               report.contact_count,
               report.iterations};
    if (watch_.sample) watch_.sample(sample_);
  }

  static double periodic_change(double d, double period) { return d - period * std::rint(d / period); }

  bool covered() const { return x_ >= setup_.run_in_distance + setup_.test_distance; }
  bool slid_back() const { return x_ < -setup_.thresholds.slid_back_share * setup_.rig.vehicle_length; }

  /// Net progress over the last `immobile_time` of full-speed driving below the immobile speed.
  bool immobile() const {
    const double window = setup_.thresholds.immobile_time;
    if (drive_time() < setup_.ramp_time + window) return false;
    const auto back = std::size_t(std::lround(window / numerics_.step));
    if (samples_.size() <= back) return false;
    const Sample &now = samples_.back(), &then = samples_[samples_.size() - 1 - back];
    return now.x - then.x < setup_.thresholds.immobile_speed * window;
  }

  bool decided() const {
    if (flags_ != 0 || drive_time() >= setup_.time_limit || slid_back()) return true;
    return drive_time() >= setup_.ramp_time + setup_.minimum_drive_time && (covered() || immobile());
  }

  DriveOutcome outcome() const {
    DriveOutcome o = measures();
    std::tie(o.verdict, o.reason) = verdict(o);
    return o;
  }

  /// First true line of the contract's verdict table wins.
  std::pair<Verdict, Reason> verdict(const DriveOutcome& o) const {
    const Thresholds& t = setup_.thresholds;
    if (slid_back()) return {Verdict::no_go, Reason::slid_back};
    if (covered()) {
      const bool fast = o.mean_speed >= t.go_speed_share * conditions_.speed && o.slip <= t.go_slip;
      return {fast ? Verdict::go : Verdict::slow_go, Reason::none};
    }
    if (immobile()) {
      const bool turning = rolled_in_window() > 0.5 * conditions_.speed * t.immobile_time;
      if (!turning) return {Verdict::no_go, Reason::power};
      if (o.sinkage > setup_.rig.ground_clearance) return {Verdict::no_go, Reason::sinkage};
      return {Verdict::no_go, Reason::traction};
    }
    return {Verdict::no_go, Reason::timeout};
  }

  double rolled_in_window() const {
    const auto back = std::size_t(std::lround(setup_.thresholds.immobile_time / numerics_.step));
    return samples_.back().rolled - samples_[samples_.size() - 1 - std::min(back, samples_.size() - 1)].rolled;
  }

  DriveOutcome measures() const {
    DriveOutcome o{};
    o.flags = flags_;
    o.worst_residual = worst_residual_;
    o.energy_error = energy_.motor_work > 0 ? energy_.gained / energy_.motor_work : 0;
    o.drift = y_;
    o.distance = std::max(0.0, x_ - setup_.run_in_distance);
    if (samples_.size() < 4) return o;
    const Sample &end = samples_.back(), &half = samples_[samples_.size() / 2];
    o.drive_time = end.time;
    o.mean_speed = (end.x - half.x) / (end.time - half.time);
    o.slip = end.rolled > half.rolled ? 1 - (end.x - half.x) / (end.rolled - half.rolled) : kNaN;
    double work = 0;
    const std::size_t first = samples_.size() / 2, count = samples_.size() - first;
    for (std::size_t k = first; k < samples_.size(); ++k) {
      o.sinkage += samples_[k].sinkage / double(count);
      o.mean_torque += samples_[k].torque / double(count);
      work += samples_[k].motor_power * numerics_.step;
    }
    o.energy_per_metre = end.x > half.x ? work / (end.x - half.x) : kNaN;
    return o;
  }

  const TrialSetup& setup_;
  const TrialConditions& conditions_;
  const TrialNumerics& numerics_;
  const TrialWatch& watch_;
  double surface_;
  const sim::SceneWorld& world_;
  std::unique_ptr<sim::Simulation> simulation_;
  vehicle::RigBodies bodies_;
  Vec3d last_;
  double time_ = 0, x_ = 0, y_ = 0, rolled_ = 0, worst_residual_ = 0;
  Index flags_ = 0;
  EnergyBalance energy_;
  std::vector<Sample> samples_;
  TrialSample sample_{};
  double shown_time_ = -1;
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
  Run run(setup, conditions, numerics, watch, surface, world,
          sim::make_simulation(sim::Backend::cpu, {world}, settings, 1), bodies);
  DriveOutcome outcome = run.until_decided();
  outcome.bed_creep = bed.bed_creep;
  outcome.worst_residual = std::max(outcome.worst_residual, bed.worst_residual);
  return outcome;
}

}  // namespace gonogo::pipeline
