#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/cancel.h"
#include "base/error.h"
#include "pipeline/lab/bench/timing.h"
#include "pipeline/lab/scenes/picture.h"
#include "sim/io/vtk_series.h"

namespace gonogo::lab {
namespace {

/// Steps of a scene, with its drive called when it is due.
class Driven {
 public:
  Driven(const ManyScene& scene, sim::Simulation& simulation) : scene_(scene), simulation_(simulation) {}

  double time() const { return double(steps_) * simulation_.settings().step; }

  void advance(int count) {
    for (int k = 0; k < count;) {
      const int steps = std::min(due(), count - k);
      simulation_.advance(steps);
      steps_ += steps;
      k += steps;
    }
  }

  /// Seconds of a step in a sample that no drive interrupts.
  double sample(int steps) {
    if (due() < steps) advance(due());
    due();
    const double time = seconds_per_step(simulation_, 1, steps);
    steps_ += steps;
    return time;
  }

  sim::StageTimes timed_step() {
    due();
    ++steps_;
    return sim::by_stage(simulation_).timed_step();
  }

 private:
  /// Drives where it is time to; returns how many steps follow until the next one.
  int due() {
    const int since = int(steps_ % kStepsPerDrive);
    if (since == 0 && driven_at_ != steps_ && scene_.drive) scene_.drive(simulation_, time());
    driven_at_ = since == 0 ? steps_ : driven_at_;
    return kStepsPerDrive - since;
  }

  const ManyScene& scene_;
  sim::Simulation& simulation_;
  std::int64_t steps_ = 0, driven_at_ = -1;
};

void check_flags(const ManyScene& scene, sim::Simulation& simulation) {
  if (const sim::StepReport report = simulation.report(0); report.flags != 0)
    throw DeviceError(scene.name + ": " + sim::description(report.fault, scene.settings.step));
}

/// Frames of a run while it goes on.
class Frames {
 public:
  Frames(const ManyScene& scene, const ManyRun& run) : run_(run) {
    if (!run.vtk.empty()) series_.emplace(run.vtk, scene.world);
  }

  void add(sim::Simulation& simulation) {
    if (!series_ && run_.video.empty()) return;
    sim::Capture state = sim::capture_world(simulation, 0);
    if (series_) series_->write(state);
    if (run_.video.empty()) return;
    state.contact = {};
    held_.push_back(std::move(state));
  }

  void finish(const ManyScene& scene) const {
    if (!run_.video.empty()) draw_video(run_.video, scene, held_, run_.every, run_.on.threads);
  }

 private:
  const ManyRun& run_;
  std::optional<sim::VtkSeries> series_;
  std::vector<sim::Capture> held_;
};

int steps_in(double time, const ManyScene& scene) { return std::max(1, int(std::lround(time / scene.settings.step))); }

/// The scene's duration, in stretches between frames and looks.
void play(const ManyScene& scene, const ManyRun& run, sim::Simulation& simulation, Driven& driven, ManyResult& r) {
  Frames frames(scene, run);
  const int all = int(std::lround(scene.duration / scene.settings.step)), per_frame = steps_in(run.every, scene),
            per_look = scene.watch ? steps_in(scene.watch_every, scene) : all;
  for (int done = 0;;) {
    check_flags(scene, simulation);
    if (done % per_frame == 0 || done == all) frames.add(simulation);
    if (scene.watch && (done % per_look == 0 || done == all))
      r.watched.push_back(scene.watch(simulation, driven.time()));
    if (done == all) break;
    stop_if_cancelled();
    const int steps = std::min({all - done, per_frame - done % per_frame, per_look - done % per_look});
    driven.advance(steps);
    done += steps;
  }
  frames.finish(scene);
}

void time_steps(const ManyRun& run, sim::Simulation& simulation, Driven& driven, ManyResult& r) {
  std::vector<double> samples;
  std::vector<sim::StageTimes> stages;
  for (int k = 0; k < run.repeats; ++k) samples.push_back(driven.sample(run.steps_per_sample));
  for (int k = 0; k < run.repeats; ++k) stages.push_back(driven.timed_step());
  const double time = median(samples);
  r.stages = median_times(stages);
  const double updates = double(simulation.report(0).contact_count) * r.iterations;
  const double solve = r.stages.of(sim::Stage::solve);
  r.ms_per_step = time * 1e3;
  r.ns_per_contact_iteration = time * 1e9 / updates;
  r.ns_per_contact_iteration_solver = solve * 1e9 / updates;
  r.copy_bandwidth = sim::copy_bandwidth(run.on.backend, run.on.threads);
  r.bandwidth_share = sim::by_stage(simulation).solver_traffic() * r.iterations / solve / r.copy_bandwidth;
}

}  // namespace

sim::StageTimes median_times(const std::vector<sim::StageTimes>& samples) {
  sim::StageTimes times;
  for (int k = 0; k < sim::kStageCount; ++k) {
    std::vector<double> of_stage;
    for (const sim::StageTimes& sample : samples) of_stage.push_back(sample.seconds[k]);
    times.seconds[k] = median(of_stage);
  }
  return times;
}

std::function<std::vector<Measured>(sim::Simulation&, double time)> over_time(
    std::function<std::vector<Measured>(sim::Simulation&)> measure) {
  return [measure = std::move(measure)](sim::Simulation& simulation, double time) {
    std::vector<Measured> m = measure(simulation);
    m.insert(m.begin(), {"time_s", time});
    return m;
  };
}

ManyResult run_many(const ManyScene& scene, const ManyRun& run) {
  sim::require_backend(run.on.backend);
  if (!run.plot.empty() && !scene.watch)
    throw InputError("--plot: the scene " + scene.name + " records nothing over time; leave the option out");
  if (!run.picture.empty() || !run.video.empty() || !run.plot.empty()) require_pictures(!run.video.empty());
  const double start = seconds();
  const auto simulation = sim::make_simulation(run.on.backend, {scene.world}, scene.settings, run.on.threads);
  Driven driven(scene, *simulation);
  driven.advance(1);
  ManyResult r;
  r.build_seconds = seconds() - start;
  play(scene, run, *simulation, driven, r);
  r.run_seconds = seconds() - start - r.build_seconds;
  if (scene.measure) r.measured = scene.measure(*simulation);
  if (!run.picture.empty()) {
    const sim::Capture state = sim::capture_world(*simulation, 0);
    draw_snapshot(run.picture, scene, state, view_of(scene, {&state}), run.on.threads);
  }
  if (!run.plot.empty()) draw_watched(run.plot, scene, r.watched);
  r.bodies = std::int64_t(scene.world.body.size());
  r.iterations = scene.settings.iterations;
  if (run.repeats > 0) time_steps(run, *simulation, driven, r);
  check_flags(scene, *simulation);
  r.contacts = simulation->report(0).contact_count;
  r.residual_m_per_s = simulation->report(0).rms_residual;
  return r;
}

}  // namespace gonogo::lab
