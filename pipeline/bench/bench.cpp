#include "pipeline/bench/bench.h"

#include <algorithm>
#include <chrono>

#include "base/progress.h"
#include "terrain/soil/bed.h"

namespace gonogo::pipeline {
namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

BedBenchResult bench_bed(const BedBench& request) {
  terrain::BedSpec spec;
  spec.grain_diameter = request.grain_diameter;
  log_line("bench", "settling the bed, or reading it from " + request.packing_folder.string());
  const terrain::Packing packing = terrain::cached_packing(spec, request.packing_folder, request.threads);
  const sim::PairLaw law{0.6f, 0.1f, 0};
  const sim::SceneWorld world = terrain::bed_world(packing, {law, law}, spec.grain_diameter);
  const auto settings = terrain::bed_step_settings(spec.grain_diameter, 1e-3, request.iterations);
  const auto simulation = sim::make_simulation(request.backend, {world}, settings, request.threads);
  simulation->advance(50);
  std::vector<double> per_step;
  for (int k = 0; k < request.steps; ++k) {
    const double start = seconds();
    simulation->advance(1);
    (void)simulation->report(0);  // waits for the device
    per_step.push_back(seconds() - start);
  }
  const sim::StepReport report = simulation->report(0);
  BedBenchResult r;
  r.bodies = Index(world.body.size());
  r.contacts = report.contact_count;
  r.iterations = request.iterations;
  r.ms_per_step = median(per_step) * 1e3;
  r.ns_per_contact_iteration = median(per_step) * 1e9 / double(r.contacts) / request.iterations;
  r.residual_m_per_s = report.rms_residual;
  return r;
}

}  // namespace gonogo::pipeline
