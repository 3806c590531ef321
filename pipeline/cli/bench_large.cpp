#include <cstdio>
#include <memory>

#include "pipeline/bench/tank.h"
#include "pipeline/cli/bench_parts.h"

namespace gonogo::pipeline::cli {
namespace {

/// Times of the stages from `first` to `last` [ms].
Json stages_json(const sim::StageTimes& times, sim::Stage first, sim::Stage last) {
  Json json;
  for (int k = int(first); k <= int(last); ++k) json[sim::kStageNames[k]] = times.seconds[k] * 1e3;
  return json;
}

std::string stages_text(const sim::StageTimes& times, sim::Stage first, sim::Stage last) {
  std::string text;
  for (int k = int(first); k <= int(last); ++k) {
    char part[64];
    std::snprintf(part, sizeof part, "  %-10s %10.3f ms\n", sim::kStageNames[k], times.seconds[k] * 1e3);
    text += part;
  }
  return text;
}

Json scene_json(const char* scene, sim::Backend backend, int threads, const TankSpec& tank, std::int64_t bodies,
                std::int64_t contacts) {
  Json json;
  json["scene"] = scene;
  json["backend"] = name_in(kBackends, backend);
  json["threads"] = threads;
  json["spheres"] = tank.spheres;
  json["bodies"] = bodies;
  json["contacts"] = contacts;
  json["contacts_per_sphere"] = double(contacts) / tank.spheres;
  return json;
}

void print_tank(const Globals& globals, const TankBench& request) {
  const TankBenchResult r = bench_tank(request);
  Json json = scene_json("tank", request.backend, request.threads, request.tank, r.bodies, r.contacts);
  json["iterations"] = request.iterations;
  json["ms_per_step"] = r.ms_per_step;
  json["stages_ms"] = stages_json(r.stages, sim::Stage::bins, sim::Stage::integrate);
  json["ns_per_contact_iteration"] = r.ns_per_contact_iteration;
  json["ns_per_contact_iteration_solver"] = r.ns_per_contact_iteration_solver;
  json["residual_m_per_s"] = r.residual_m_per_s;
  json["copy_bandwidth_B_per_s"] = r.copy_bandwidth;
  if (r.bandwidth_share) json["solver_share_of_copy_bandwidth"] = *r.bandwidth_share;
  json["build_s"] = r.build_seconds;
  char text[400];
  std::snprintf(text, sizeof text,
                "tank: %lld bodies, %lld contacts, %d iterations: %.3f ms per step, %.3f ns per contact-iteration "
                "(whole step), %.3f ns (solver), residual %.2e m/s; made in %.1f s\n",
                static_cast<long long>(r.bodies), static_cast<long long>(r.contacts), request.iterations, r.ms_per_step,
                r.ns_per_contact_iteration, r.ns_per_contact_iteration_solver, r.residual_m_per_s, r.build_seconds);
  print_result(globals, json, text + stages_text(r.stages, sim::Stage::bins, sim::Stage::integrate));
}

void print_collide(const Globals& globals, const CollideBench& request) {
  const CollideBenchResult r = bench_collide(request);
  Json json = scene_json("collide", request.backend, request.threads, request.tank, r.bodies, r.contacts);
  json["ms_per_search"] = r.ms_per_search;
  json["stages_ms"] = stages_json(r.stages, sim::Stage::bins, sim::Stage::contacts);
  json["ns_per_contact"] = r.ns_per_contact;
  json["build_s"] = r.build_seconds;
  char text[240];
  std::snprintf(text, sizeof text,
                "collide: %lld bodies, %lld contacts: %.3f ms per search, %.3f ns per contact; made in %.1f s\n",
                static_cast<long long>(r.bodies), static_cast<long long>(r.contacts), r.ms_per_search, r.ns_per_contact,
                r.build_seconds);
  print_result(globals, json, text + stages_text(r.stages, sim::Stage::bins, sim::Stage::contacts));
}

void add_spheres(CLI::App& command, Index& spheres) {
  command.add_option("--spheres", spheres, "Number of spheres")->check(CLI::Range(100, 100'000'000));
}

void add_tank(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("tank", "A shaken tank of spheres, about 3.6 contacts each");
  auto request = std::make_shared<TankBench>();
  add_spheres(*command, request->tank.spheres);
  command->add_option("--iterations", request->iterations, "Solver iterations per step")->check(CLI::Range(1, 100000));
  command->add_option("--repeats", request->repeats, "Timed samples")->check(CLI::Range(3, 100000));
  add_choice(*command, "--backend", request->backend, kBackends, "cpu or cuda");
  command->footer("Example:\n  gonogo bench tank --spheres 1000000 --backend cuda --json");
  command->callback([&globals, request] {
    request->threads = bench_threads(globals);
    print_tank(globals, *request);
  });
}

void add_collide(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("collide", "The search for contacts alone, in the same tank at rest");
  auto request = std::make_shared<CollideBench>();
  add_spheres(*command, request->tank.spheres);
  command->add_option("--repeats", request->repeats, "Timed samples")->check(CLI::Range(3, 100000));
  add_choice(*command, "--backend", request->backend, kBackends, "cpu or cuda");
  command->footer("Example:\n  gonogo bench collide --spheres 6100000 --backend cuda --json   22 million contacts");
  command->callback([&globals, request] {
    request->threads = bench_threads(globals);
    print_collide(globals, *request);
  });
}

}  // namespace

void add_large_scenes(CLI::App& bench, const Globals& globals) {
  add_tank(bench, globals);
  add_collide(bench, globals);
}

}  // namespace gonogo::pipeline::cli
