#include "pipeline/campaign/trial/judge.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/units.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::campaign {
namespace {

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
    if (setup_.task->tow().share > 0) o.pull = pull_points();
    if (const auto slip = setup_.task->given_slip()) {
      o.pull = {towed_point(o, *slip)};
      o.towed_pull = o.pull.front().pull;
      if (setup_.task->slip_angle()) o.towed_side = o.pull.front().side;
    }
    const auto [common, reason] = verdict(o);
    const DriveEnd end{.verdict = common,
                       .reason = reason,
                       .travelled = end_.now.x,
                       .drift = o.drift,
                       .vehicle_length = setup_.vehicle.length,
                       .go_slip = setup_.thresholds.go_slip,
                       .pull = o.pull};
    std::tie(o.verdict, o.reason) = setup_.task->judge(end);
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
      if (o.sinkage > setup_.vehicle.clearance) return {Verdict::no_go, Reason::sinkage};
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
      if (w.driven) {
        sum += value(w);
        ++count;
      }
    return sum / count;
  }

  sim::MonitorSample now(const WatchedWheel& w) const { return simulation_.monitor(world_, w.monitor).now; }
  sim::MonitorSample sample(Index monitor, Index i) const { return simulation_.samples(world_, monitor, i, 1).front(); }

  struct WheelMeans {
    std::vector<sim::MonitorMeans> of_wheel;
    double rolled = 0, torque = 0;  // means over the driven wheels [m], [N m]
    double work = 0, drop = 0;      // sum over the driven wheels [J]; mean over those that touch the ground [m]
  };

  /// From a sample to the one that `end` gives of each wheel.
  template <class EndOf>
  WheelMeans means(Index from, EndOf&& end) const {
    WheelMeans mean;
    double driven = 0;
    for (const WatchedWheel& w : wheels_) {
      const sim::MonitorMeans& of =
          mean.of_wheel.emplace_back(sim::means_between(sample(w.monitor, from), end(w), step_));
      if (w.sinks) mean.drop += of.drop / sinking(wheels_);
      if (!w.driven) continue;
      mean.rolled += of.turned * w.radius;
      mean.work += of.work;
      mean.torque += of.torque;
      ++driven;
    }
    mean.rolled /= driven;
    mean.torque /= driven;
    return mean;
  }

  DriveOutcome measures() {
    DriveOutcome o;
    o.flags = end_.now.flags;
    o.worst_residual = end_.worst_residual;
    // A carriage that tows a wheel does work that the monitor does not see: there is no balance.
    const bool towed = setup_.task->given_slip().has_value();
    o.energy_error = !towed && end_.exchanged > 0 ? end_.energy_gained / end_.exchanged : 0;
    o.drift = end_.now.y;
    o.distance = std::max(0.0, end_.now.x - setup_.run_in_distance);
    // One sample per step; driving begins with the step that ends at park_time.
    const auto parked = Index(std::lround(setup_.park_time / step_));
    const Index first = std::max<Index>(0, parked - 1), driven = end_.sample_count - first;
    if (driven < 4) return o;
    o.drive_time = (end_.now.step - parked) * step_;
    const sim::MonitorMeans half = sim::means_between(sample(0, first + driven / 2), end_.now, step_);
    const WheelMeans mean = means(first + driven / 2, [&](const WatchedWheel& w) { return now(w); });
    if (wheels_.size() > 1)
      for (std::size_t i = 0; i < wheels_.size(); ++i)
        o.wheels.push_back(record_of(wheels_[i], mean.of_wheel[i], half.x));
    o.mean_speed = half.x / half.time;
    o.slip = mean.rolled > 0 ? 1 - half.x / mean.rolled : kNaN;
    o.sinkage = mean.drop;
    o.mean_torque = mean.torque;
    o.energy_per_metre = half.x > 0 ? mean.work / half.x : kNaN;
    return o;
  }

  /// Means over equal parts of the sweep.
  std::vector<PullPoint> pull_points() {
    constexpr Index parts = 10;
    const TowPlan tow = setup_.task->tow();
    const auto first = Index(std::lround(setup_.tow_start() / step_)), sweep = Index(std::lround(tow.ramp / step_));
    std::vector<PullPoint> points;
    for (Index k = 0; k < parts; ++k) {
      const Index from = first + k * sweep / parts, to = first + (k + 1) * sweep / parts;
      if (to > end_.sample_count || to - from < 2) break;
      points.push_back(pull_point(from - 1, to - 1, tow.share * (k + 0.5) / parts));
    }
    add_inertia(points, double(sweep) / parts * step_);
    return points;
  }

  /// The wheels have the load left over and what accelerates the vehicle: by the mean speeds of the parts around.
  void add_inertia(std::vector<PullPoint>& points, double time) const {
    const std::vector<PullPoint> at = points;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const std::size_t before = k > 0 ? k - 1 : k, after = k + 1 < at.size() ? k + 1 : k;
      if (after == before) continue;
      points[k].pull += (at[after].speed - at[before].speed) / (double(after - before) * time) / setup_.gravity;
    }
  }

  /// Pull of a towed wheel: mean forces of the carriage's springs and dampers over the last half.
  PullPoint towed_point(const DriveOutcome& o, double slip) const {
    const double speed = conditions_.speed * (1 - slip), weight = setup_.weight(conditions_.payload);
    const Index first = end_.sample_count / 2, count = end_.sample_count - first;
    const auto samples = simulation_.samples(world_, 0, first, count);
    const auto force = [&](auto stretch) {
      double mean = 0;
      for (const sim::MonitorSample& s : samples) mean += stretch(s) / count;
      const double rate = (stretch(samples.back()) - stretch(samples.front())) / ((count - 1) * step_);
      return kCarriageStiffness * mean + carriage_damping(weight / setup_.gravity) * rate;
    };
    const double along = force([&](const sim::MonitorSample& s) { return s.x - speed * s.step * step_; });
    PullPoint p{
        .pull = along / weight, .slip = o.slip, .speed = o.mean_speed, .sinkage = o.sinkage, .torque = o.mean_torque};
    if (const auto angle = setup_.task->slip_angle()) {
      const double across = force([](const sim::MonitorSample& s) { return s.y; });
      p.pull = (std::cos(*angle) * along + std::sin(*angle) * across) / weight;
      p.side = (std::cos(*angle) * across - std::sin(*angle) * along) / weight;
    }
    return p;
  }

  /// Between two samples, under a mean load.
  PullPoint pull_point(Index from, Index to, double load) const {
    const sim::MonitorMeans of = sim::means_between(sample(0, from), sample(0, to), step_);
    const WheelMeans mean = means(from, [&](const WatchedWheel& w) { return sample(w.monitor, to); });
    return {.pull = load,
            .slip = mean.rolled > 0 ? 1 - of.x / mean.rolled : kNaN,
            .speed = of.x / of.time,
            .sinkage = mean.drop,
            .torque = mean.torque};
  }

  static WheelRecord record_of(const WatchedWheel& w, const sim::MonitorMeans& of, double travelled) {
    const double rolled = of.turned * w.radius;
    return {.name = w.name,
            .slip = w.driven && rolled > 0 ? 1 - travelled / rolled : kNaN,
            .sinkage = w.sinks ? of.drop : kNaN,
            .torque = of.torque};
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

std::vector<WatchedWheel> watched_wheels(const TrialSetup& setup) {
  const Index first = first_wheel_monitor(setup.vehicle);
  std::vector<WatchedWheel> wheels;
  for (const vehicle::RunningPart& p : vehicle::running_parts(setup.vehicle))
    wheels.push_back({.name = p.name,
                      .monitor = first + Index(wheels.size()),
                      .radius = p.rolling_radius,
                      .driven = p.driven,
                      .sinks = p.reach > 0});
  return wheels;
}

double sinking(const std::vector<WatchedWheel>& wheels) {
  return double(std::count_if(wheels.begin(), wheels.end(), [](const WatchedWheel& w) { return w.sinks; }));
}

DriveOutcome outcome_of_failed_bed(const TiltedBed& bed) {
  DriveOutcome o;
  o.flags = bed.flags;
  o.worst_residual = bed.residual;
  o.bed_creep = bed.creep;
  if (bed.flags == 0) {
    o.verdict = Verdict::no_go;
    o.reason = Reason::slope_unstable;
  }
  o.slip = o.sinkage = o.drift = o.mean_torque = o.energy_per_metre = kNaN;
  return o;
}

static_assert(int(check_not_finite) == sim::flag_not_finite && int(check_too_fast) == sim::flag_too_fast &&
              int(check_left_domain) == sim::flag_left_domain);

std::uint64_t failed_checks(const TrialSetup& setup, const DriveOutcome& o) {
  std::uint64_t failed = std::uint64_t(o.flags);
  if (!(o.worst_residual <= setup.thresholds.residual)) failed |= check_residual;
  if (!(o.energy_error <= setup.thresholds.energy_error)) failed |= check_energy;
  return failed;
}

void store_measures(const DriveOutcome& o, TrialRecord& record) {
  const auto set = [&](const char* name, double x) { record.measures[contract().measure_index(name)] = x; };
  set("distance", o.distance);
  set("drive_time", o.drive_time);
  set("mean_speed", o.mean_speed);
  set("slip", o.slip);
  set("sinkage", o.sinkage);
  set("drift", o.drift);
  set("mean_torque", o.mean_torque);
  set("energy_per_metre", o.energy_per_metre);
  set("bed_creep", o.bed_creep);
  set("worst_residual", o.worst_residual);
  set("energy_error", o.energy_error);
  set("pull", o.towed_pull);
  set("side_force", o.towed_side);
}

DriveOutcome judge_drive(const TrialSetup& setup, const TrialConditions& conditions, const TiltedBed& bed, double step,
                         sim::Simulation& simulation, sim::WorldIndex world) {
  DriveOutcome outcome = Judge(setup, conditions, step, simulation, world).outcome();
  outcome.bed_creep = bed.creep;
  outcome.worst_residual = std::max(outcome.worst_residual, bed.residual);
  return outcome;
}

}  // namespace gonogo::campaign
