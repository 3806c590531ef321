#include "pipeline/lab/bench/bed.h"

#include "base/progress.h"
#include "pipeline/lab/bench/timing.h"
#include "terrain/bed/bed.h"

namespace gonogo::lab {
namespace {

sim::SceneWorld bench_world(const BedBench& request) {
  terrain::BedSpec spec;
  spec.grain_diameter = request.grain_diameter;
  spec.length = request.length;
  spec.width = request.width;
  spec.depth = request.depth;
  log_line("bench", "settling the bed, or reading it from " + request.packing_folder.string());
  const terrain::Packing packing = terrain::cached_packing(spec, request.packing_folder, request.threads);
  const sim::PairLaw law{Real(request.friction), Real(request.rolling_friction), 0};
  return terrain::bed_world(terrain::tiled(packing, request.copies, 1), {law, law}, spec.grain_diameter);
}

}  // namespace

BedBenchResult bench_bed(const BedBench& request) {
  sim::require_backend(request.backend);
  const sim::SceneWorld world = bench_world(request);
  const sim::Scene scene(std::size_t(request.worlds), world);
  const auto timed = [&](int iterations, BedBenchResult& r) {
    const auto settings = terrain::bed_step_settings(request.grain_diameter, 1e-3, iterations);
    const auto simulation = sim::make_simulation(request.backend, scene, settings, request.threads);
    simulation->advance(20);
    const double time = seconds_per_step(*simulation, request.repeats, request.steps_per_sample);
    const sim::StepReport report = simulation->report(0);
    r.contacts = std::int64_t(report.contact_count) * request.worlds;
    r.residual_m_per_s = report.rms_residual;
    return time;
  };
  BedBenchResult few, r;
  const int less = std::max(1, request.iterations / 5);
  const double quick = timed(less, few), time = timed(request.iterations, r);
  r.worlds = request.worlds;
  r.bodies = std::int64_t(world.body.size()) * request.worlds;
  r.iterations = request.iterations;
  r.ms_per_step = time * 1e3;
  r.ns_per_contact_iteration = time * 1e9 / double(r.contacts) / request.iterations;
  r.ns_per_contact_iteration_solver =
      (time * 1e9 / double(r.contacts) - quick * 1e9 / double(few.contacts)) / (request.iterations - less);
  return r;
}

}  // namespace gonogo::lab
