#include "pipeline/campaign/trial/watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/format.h"

namespace gonogo::campaign {

std::string csv_line(const TrialSample& s) {
  return line("%.4f,%.5f,%.5f,%.5f,%.4f,%.4f,%.2f,%.3e,%d,%d\n", s.time, s.x, s.y, s.sinkage, s.speed, s.slip, s.torque,
              s.residual, s.contacts, s.iterations);
}

TrialWatcher::TrialWatcher(const TrialSetup& setup, TrialWatch watch)
    : watch_(std::move(watch)), wheels_(watched_wheels(setup)) {}

void TrialWatcher::begin_attempt(double step) {
  step_ = step;
  shown_samples_ = 0;
  frame_count_ = 0;
  replay_to_ = 0;
  if (watch_.start) watch_.start();
}

void TrialWatcher::show_failed_bed(const RunningWorld& now, double residual) {
  if (!watch_.frame) return;
  const TrialSample sample{.residual = residual};
  watch_.frame({.sample = sample, .world = now.world, .simulation = now.simulation, .place = now.place, .wheel = -1});
}

void TrialWatcher::begin_drive(const RunningWorld& now) {
  show_samples(now, false);
  if (now.step == 0) show_frame(now);
  pass_due_frames(now.step);
  remember(now);
}

void TrialWatcher::look(const RunningWorld& now, bool stopped) {
  show_shares(now);
  show_samples(now, stopped);
  if (stopped || now.step >= next_frame()) show_frame(now);
  if (!stopped) remember(now);
}

void TrialWatcher::show_shares(const RunningWorld& now) {
  if (!watch_.shares) return;
  const std::vector<sim::PartShare> shares = now.simulation.shares();
  if (!shares.empty()) watch_.shares(shares);
}

Index TrialWatcher::next_look(Index step) const { return replay_to_ > step ? replay_to_ : next_frame(); }

std::optional<Index> TrialWatcher::rewind(const RunningWorld& now, Index stop) {
  if (!watch_.frame) return {};
  now.simulation.restore(now.place, before_);
  replay_to_ = stop;
  return before_.steps;
}

Index TrialWatcher::next_frame() const {
  if (!watch_.frame) return std::numeric_limits<Index>::max();
  return Index(std::min(1e9, std::round(double(frame_count_) * watch_.frame_interval / step_)));
}

void TrialWatcher::pass_due_frames(Index step) {
  while (next_frame() <= step) ++frame_count_;
}

void TrialWatcher::remember(const RunningWorld& now) {
  if (watch_.frame) before_ = now.simulation.snapshot(now.place);
}

template <class SampleOf>
TrialWatcher::Means TrialWatcher::mean_of_wheels(SampleOf&& sample_of) const {
  Means seen;
  double driven = 0;
  for (const WatchedWheel& w : wheels_) {
    const sim::MonitorSample now = sample_of(w.monitor);
    if (w.sinks) seen.sinkage += now.drop / sinking(wheels_);
    if (!w.driven) continue;
    seen.rolled += now.turned * w.radius;
    seen.torque += now.torque;
    ++driven;
  }
  seen.rolled /= driven;
  seen.torque /= driven;
  return seen;
}

TrialWatcher::Means TrialWatcher::means_at(const RunningWorld& now, Index sample) const {
  return mean_of_wheels([&](Index m) { return now.simulation.samples(now.place, m, sample, 1).front(); });
}

/// Slip of the latest 0.25 s, of which `x` and `rolled` [m] are the end, the `count`-th recorded sample. Wheels that
/// hardly roll, as while the vehicle is let down with its brakes on, have none.
double TrialWatcher::recent_slip(const RunningWorld& now, Index count, double x, double rolled) const {
  constexpr double window = 0.25, rolling = 0.01;  // [s], [m]
  const Index back = Index(std::lround(window / step_));
  double x_then = 0, rolled_then = 0;
  if (count > back) {
    x_then = now.simulation.samples(now.place, 0, count - 1 - back, 1).front().x;
    rolled_then = means_at(now, count - 1 - back).rolled;
  }
  const double turned = rolled - rolled_then;
  return turned > rolling ? 1 - (x - x_then) / turned : 0;
}

TrialSample TrialWatcher::seen(const RunningWorld& now, const sim::MonitorSample& s, const Means& wheels,
                               Index count) const {
  return {.time = s.step * step_,
          .x = s.x,
          .y = s.y,
          .sinkage = wheels.sinkage,
          .speed = s.speed,
          .slip = recent_slip(now, count, s.x, wheels.rolled),
          .torque = wheels.torque,
          .residual = s.residual,
          .contacts = s.contact_count,
          .iterations = s.iterations};
}

void TrialWatcher::show_samples(const RunningWorld& now, bool stopped) {
  if (!watch_.sample) return;
  const Index every = std::max<Index>(1, Index(std::lround(watch_.sample_interval / step_)));
  const Index count = now.simulation.monitor(now.place, 0).sample_count - shown_samples_;
  const auto samples = now.simulation.samples(now.place, 0, shown_samples_, count);
  for (Index k = 0; k < count; ++k) {
    const Index at = shown_samples_ + k;
    if ((at + 1) % every != 0 && !(stopped && k + 1 == count)) continue;
    watch_.sample(seen(now, samples[std::size_t(k)], means_at(now, at), at + 1));
  }
  shown_samples_ += count;
}

void TrialWatcher::show_frame(const RunningWorld& now) {
  if (!watch_.frame) return;
  const sim::MonitorState monitor = now.simulation.monitor(now.place, 0);
  const Means wheels = mean_of_wheels([&](Index m) { return now.simulation.monitor(now.place, m).now; });
  const TrialSample sample = seen(now, monitor.now, wheels, monitor.sample_count);
  watch_.frame({.sample = sample,
                .world = now.world,
                .simulation = now.simulation,
                .place = now.place,
                .wheel = now.world.monitor.front().body});
  pass_due_frames(now.step);
}

}  // namespace gonogo::campaign
