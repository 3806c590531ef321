#include "pipeline/bench/tank.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "pipeline/bench/timing.h"

namespace gonogo::pipeline {
namespace {

/// Acceleration of the tank's walls [m/s^2].
double shaking(double time) { return 0.5 * 9.81 * std::sin(2 * std::numbers::pi * 2 * time); }

class ShakenTank {
 public:
  ShakenTank(sim::Simulation& simulation) : simulation_(simulation) {}

  /// Gravity as felt inside of the tank, for the steps to come.
  void lean() {
    const double time = double(steps_) * simulation_.settings().step;
    simulation_.set_gravity(0, {Real(-shaking(time)), 0, Real(-9.81)});
  }

  void advance(int count) {
    for (int k = 0; k < count; k += kStepsPerLean) {
      lean();
      const int steps = std::min(kStepsPerLean, count - k);
      simulation_.advance(steps);
      steps_ += steps;
    }
  }

  double seconds_per_step(int repeats, int steps_per_sample) {
    std::vector<double> samples;
    for (int k = 0; k < repeats; ++k) {
      lean();
      samples.push_back(pipeline::seconds_per_step(simulation_, 1, steps_per_sample));
      steps_ += steps_per_sample;
    }
    return median(samples);
  }

  sim::StageTimes timed_step() {
    lean();
    ++steps_;
    return sim::by_stage(simulation_).timed_step();
  }

 private:
  static constexpr int kStepsPerLean = 10;
  sim::Simulation& simulation_;
  std::int64_t steps_ = 0;
};

sim::StageTimes median_times(const std::vector<sim::StageTimes>& samples) {
  sim::StageTimes times;
  for (int k = 0; k < sim::kStageCount; ++k) {
    std::vector<double> of_stage;
    for (const sim::StageTimes& sample : samples) of_stage.push_back(sample.seconds[k]);
    times.seconds[k] = median(of_stage);
  }
  return times;
}

}  // namespace

TankBenchResult bench_tank(const TankBench& request) {
  sim::require_backend(request.backend);
  const double start = seconds();
  const auto settings = tank_step_settings(request.tank, request.iterations);
  const auto simulation = sim::make_simulation(
      request.backend, {tank_world(request.tank, request.backend, request.threads)}, settings, request.threads);
  ShakenTank tank(*simulation);
  tank.advance(1);
  TankBenchResult r;
  r.build_seconds = seconds() - start;
  tank.advance(request.warm_up);
  const double time = tank.seconds_per_step(request.repeats, request.steps_per_sample);
  std::vector<sim::StageTimes> stages;
  for (int k = 0; k < request.repeats; ++k) stages.push_back(tank.timed_step());
  r.stages = median_times(stages);
  const sim::StepReport report = simulation->report(0);
  if (report.flags != 0) throw DeviceError("tank: " + sim::description(report.fault, settings.step));
  r.bodies = request.tank.spheres + 1;
  r.contacts = report.contact_count;
  r.residual_m_per_s = report.rms_residual;
  r.ms_per_step = time * 1e3;
  const double updates = double(r.contacts) * request.iterations, solve = r.stages.of(sim::Stage::solve);
  r.ns_per_contact_iteration = time * 1e9 / updates;
  r.ns_per_contact_iteration_solver = solve * 1e9 / updates;
  r.copy_bandwidth = sim::copy_bandwidth(request.backend, request.threads);
  if (const auto bytes = sim::by_stage(*simulation).solver_traffic())
    r.bandwidth_share = *bytes * request.iterations / solve / r.copy_bandwidth;
  return r;
}

CollideBenchResult bench_collide(const CollideBench& request) {
  sim::require_backend(request.backend);
  const double start = seconds();
  const auto simulation =
      sim::make_simulation(request.backend, {tank_world(request.tank, request.backend, request.threads)},
                           tank_step_settings(request.tank, 1), request.threads);
  sim::StepByStage& stages = sim::by_stage(*simulation);
  CollideBenchResult r;
  r.contacts = stages.timed_search().contact_count;
  r.build_seconds = seconds() - start;
  std::vector<sim::StageTimes> samples;
  std::vector<double> whole;
  for (int k = 0; k < request.repeats; ++k) {
    samples.push_back(stages.timed_search().times);
    whole.push_back(samples.back().of(sim::Stage::bins) + samples.back().of(sim::Stage::contacts));
  }
  r.bodies = request.tank.spheres + 1;
  r.stages = median_times(samples);
  r.ms_per_search = median(whole) * 1e3;
  r.ns_per_contact = median(whole) * 1e9 / double(r.contacts);
  return r;
}

}  // namespace gonogo::pipeline
