#include "pipeline/lab/scenes/collide.h"

#include "pipeline/lab/bench/timing.h"

namespace gonogo::lab {

CollideBenchResult bench_collide(const CollideBench& request) {
  sim::require_backend(request.on.backend);
  const double start = seconds();
  const auto simulation = sim::make_simulation(request.on.backend, {tank_world(request.tank, request.on)},
                                               many_step_settings(request.tank.of, 1), request.on.threads);
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
  r.bodies = request.tank.of.count + 1;
  r.stages = median_times(samples);
  r.ms_per_search = median(whole) * 1e3;
  r.ns_per_contact = median(whole) * 1e9 / double(r.contacts);
  return r;
}

}  // namespace gonogo::lab
