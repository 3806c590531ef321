#include <cstdio>
#include <memory>
#include <string>

#include "pipeline/bench/bench.h"
#include "pipeline/cli/command.h"
#include "pipeline/trial/setup.h"

namespace gonogo::pipeline::cli {
namespace {

void print_bed(const Globals& globals, const BedBench& request) {
  const BedBenchResult r = bench_bed(request);
  Json json;
  json["scene"] = "bed";
  json["backend"] = request.backend == sim::Backend::cuda ? "cuda" : "cpu";
  json["threads"] = request.threads;
  json["grain_diameter_m"] = request.grain_diameter;
  json["bodies"] = r.bodies;
  json["contacts"] = r.contacts;
  json["iterations"] = r.iterations;
  json["ms_per_step"] = r.ms_per_step;
  json["ns_per_contact_iteration"] = r.ns_per_contact_iteration;
  json["residual_m_per_s"] = r.residual_m_per_s;
  char text[256];
  std::snprintf(text, sizeof text,
                "bed: %d bodies, %d contacts, %d iterations: %.3f ms per step, %.2f ns per contact-iteration "
                "(whole step), residual %.2e m/s\n",
                r.bodies, r.contacts, r.iterations, r.ms_per_step, r.ns_per_contact_iteration, r.residual_m_per_s);
  print_result(globals, json, text);
}

void add_bed(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("bed", "A settled bed of grains, 4 x 0.8 x 0.3 m, at rest");
  auto request = std::make_shared<BedBench>();
  auto backend = std::make_shared<std::string>("cpu");
  command->add_option("--grain", request->grain_diameter, "Grain diameter [m]")->check(CLI::Range(0.01, 0.2));
  command->add_option("--iterations", request->iterations, "Solver iterations per step")->check(CLI::Range(1, 100000));
  command->add_option("--steps", request->steps, "Steps to time")->check(CLI::Range(3, 100000));
  command->add_option("--backend", *backend, "cpu or cuda")->check(CLI::IsMember({"cpu", "cuda"}));
  command->footer("Example:\n  gonogo bench bed --json            one core; --threads 2 uses two");
  command->callback([&globals, request, backend] {
    request->backend = *backend == "cuda" ? sim::Backend::cuda : sim::Backend::cpu;
    request->threads = globals.threads > 0 ? globals.threads : 1;
    request->packing_folder = default_packing_folder();
    print_bed(globals, *request);
  });
}

}  // namespace

void add_bench_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("bench", "Fixed scenes, timed");
  command->require_subcommand(1);
  command->footer("Example:\n  gonogo bench bed --json");
  add_bed(*command, globals);
}

}  // namespace gonogo::pipeline::cli
