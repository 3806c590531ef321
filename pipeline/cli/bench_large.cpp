#include <cstdio>
#include <memory>

#include "pipeline/bench/ball.h"
#include "pipeline/bench/collapse.h"
#include "pipeline/bench/collide.h"
#include "pipeline/bench/crater.h"
#include "pipeline/bench/drum.h"
#include "pipeline/bench/nut.h"
#include "pipeline/bench/silo.h"
#include "pipeline/bench/timing.h"
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

Json scene_json(const std::string& scene, sim::Backend backend, int threads, std::int64_t spheres, std::int64_t bodies,
                std::int64_t contacts) {
  Json json;
  json["scene"] = scene;
  json["backend"] = name_in(kBackends, backend);
  json["threads"] = threads;
  json["spheres"] = spheres;
  json["bodies"] = bodies;
  json["contacts"] = contacts;
  json["contacts_per_sphere"] = double(contacts) / double(spheres);
  return json;
}

/// Options that all scenes with steps have.
struct ManyOptions {
  Index spheres = 16'000;
  int iterations = 50;
  ManyRun run;
};

Json many_json(const ManyScene& scene, const ManyOptions& o, const ManyResult& r, double made) {
  Json json = scene_json(scene.name, o.run.backend, o.run.threads, o.spheres, r.bodies, r.contacts);
  json["iterations"] = r.iterations;
  for (const Measured& m : r.measured) json[m.key] = m.value;
  json["simulated_s"] = scene.duration;
  json["residual_m_per_s"] = r.residual_m_per_s;
  json["made_s"] = made + r.build_seconds;
  json["run_s"] = r.run_seconds;
  if (o.run.repeats == 0) return json;
  json["ms_per_step"] = r.ms_per_step;
  json["stages_ms"] = stages_json(r.stages, sim::Stage::bins, sim::Stage::integrate);
  json["ns_per_contact_iteration"] = r.ns_per_contact_iteration;
  json["ns_per_contact_iteration_solver"] = r.ns_per_contact_iteration_solver;
  json["copy_bandwidth_B_per_s"] = r.copy_bandwidth;
  if (r.bandwidth_share) json["solver_share_of_copy_bandwidth"] = *r.bandwidth_share;
  return json;
}

std::string many_text(const ManyScene& scene, const ManyOptions& o, const ManyResult& r, double made) {
  char line[300];
  std::snprintf(line, sizeof line,
                "%s: %lld bodies, %lld contacts, residual %.2e m/s; made in %.1f s, %.2f s simulated in %.1f s\n",
                scene.name.c_str(), static_cast<long long>(r.bodies), static_cast<long long>(r.contacts),
                r.residual_m_per_s, made + r.build_seconds, scene.duration, r.run_seconds);
  std::string text = line;
  for (const Measured& m : r.measured) {
    std::snprintf(line, sizeof line, "  %-26s %10.4g\n", m.key.c_str(), m.value);
    text += line;
  }
  if (o.run.repeats == 0) return text;
  std::snprintf(line, sizeof line,
                "%d iterations: %.3f ms per step, %.3f ns per contact-iteration (whole step), %.3f ns (solver)\n",
                r.iterations, r.ms_per_step, r.ns_per_contact_iteration, r.ns_per_contact_iteration_solver);
  return text + line + stages_text(r.stages, sim::Stage::bins, sim::Stage::integrate);
}

void print_collide(const Globals& globals, const CollideBench& request) {
  const CollideBenchResult r = bench_collide(request);
  Json json = scene_json("collide", request.backend, request.threads, request.tank.spheres, r.bodies, r.contacts);
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

/// A subcommand whose scene `make(options)` builds.
template <class Make>
CLI::App* add_many(CLI::App& parent, const Globals& globals, const char* name, const char* about, Index spheres,
                   const Make& make) {
  CLI::App* command = parent.add_subcommand(name, about);
  auto o = std::make_shared<ManyOptions>();
  o->spheres = spheres;
  add_spheres(*command, o->spheres);
  command->add_option("--iterations", o->iterations, "Solver iterations per step")->check(CLI::Range(1, 100000));
  command->add_option("--repeats", o->run.repeats, "Timed samples at the end; 0: none")->check(CLI::Range(0, 100000));
  command->add_option("--vtk", o->run.vtk, "Folder for VTK files that ParaView opens");
  command->add_option("--every", o->run.every, "Time between two frames [s]")->check(CLI::Range(1e-3, 1e3));
  command->add_option("--picture", o->run.picture, "PNG of the end; walls and floors are left out");
  command->add_option("--video", o->run.video, "MP4 of the run, made by ffmpeg; walls and floors are left out");
  add_choice(*command, "--backend", o->run.backend, kBackends, "cpu or cuda");
  command->callback([&globals, o, make] {
    o->run.threads = bench_threads(globals);
    sim::require_backend(o->run.backend);
    const double start = seconds();
    const ManyScene scene = make(*o);
    const double made = seconds() - start;
    const ManyResult r = run_many(scene, o->run);
    print_result(globals, many_json(scene, *o, r, made), many_text(scene, *o, r, made));
  });
  return command;
}

void add_tank(CLI::App& parent, const Globals& globals) {
  add_many(parent, globals, "tank", "A shaken tank of spheres, about 3.6 contacts each", 100'000,
           [](const ManyOptions& o) {
             TankSpec spec;
             spec.spheres = o.spheres;
             return shaken_tank(spec, o.iterations, o.run.backend, o.run.threads);
           })
      ->footer("Example:\n  gonogo bench tank --spheres 1000000 --backend cuda --json");
}

void add_silo(CLI::App& parent, const Globals& globals) {
  auto spec = std::make_shared<SiloSpec>();
  CLI::App* command = add_many(parent, globals, "silo", "A silo with a flat floor, filled and opened", spec->spheres,
                               [spec](const ManyOptions& o) {
                                 spec->spheres = o.spheres;
                                 return silo_scene(*spec, o.iterations);
                               });
  command->add_option("--orifice", spec->orifice_diameters, "Hole, in sphere diameters; 0: a third of the silo's width")
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--flow-time", spec->flow_time, "Simulated after the opening [s]")->check(CLI::Range(0.01, 1e4));
  command->add_option("--slenderness", spec->slenderness, "Height of the fill over the silo's width, about")
      ->check(CLI::Range(0.2, 20.0));
  command->add_option("--friction", spec->of.friction, "Friction of spheres and walls [-]")
      ->check(CLI::Range(0.0, 10.0));
  command->footer("Example:\n  gonogo bench silo --spheres 128000 --backend cuda --json");
}

void add_collapse(CLI::App& parent, const Globals& globals) {
  auto spec = std::make_shared<CollapseSpec>();
  CLI::App* command = add_many(parent, globals, "collapse", "A round column that falls apart when its wall is gone",
                               spec->spheres, [spec](const ManyOptions& o) {
                                 spec->spheres = o.spheres;
                                 return collapse_scene(*spec, o.iterations);
                               });
  command->add_option("--aspect", spec->aspect, "Height of the column over its radius, about")
      ->check(CLI::Range(0.1, 20.0));
  command->add_option("--friction", spec->of.friction, "Friction of spheres and floor [-]")
      ->check(CLI::Range(0.0, 10.0));
  command->add_option("--rolling", spec->rolling_friction, "Rolling friction [-]")->check(CLI::Range(0.0, 10.0));
  command->footer("Example:\n  gonogo bench collapse --aspect 1 --picture out/collapse.png");
}

void add_crater(CLI::App& parent, const Globals& globals) {
  auto spec = std::make_shared<CraterSpec>();
  CLI::App* command =
      add_many(parent, globals, "crater", "A ball dropped onto a bed of spheres", 8000, [spec](const ManyOptions& o) {
        spec->tank.spheres = o.spheres;
        return crater_scene(*spec, o.iterations, o.run.backend, o.run.threads);
      });
  command->add_option("--height", spec->drop_height, "It falls from [m]")->check(CLI::Range(0.0, 100.0));
  command->add_option("--ball", spec->size_ratio, "Diameter of the ball, in those of the spheres")
      ->check(CLI::Range(1.5, 1000.0));
  command->footer("Example:\n  gonogo bench crater --height 1.6 --picture out/crater.png");
}

void add_drum(CLI::App& parent, const Globals& globals) {
  auto spec = std::make_shared<DrumSpec>();
  CLI::App* command = add_many(parent, globals, "drum", "Spheres of two materials in a turning drum", spec->spheres,
                               [spec](const ManyOptions& o) {
                                 spec->spheres = o.spheres;
                                 return drum_scene(*spec, o.iterations);
                               });
  command->add_option("--turns", spec->turns, "Turns of the drum")->check(CLI::Range(0.0, 1000.0));
  command->footer("Example:\n  gonogo bench drum --spheres 16000 --turns 2 --vtk out/drum");
}

void add_nut(CLI::App& parent, const Globals& globals) {
  auto spec = std::make_shared<NutSpec>();
  CLI::App* command = add_many(parent, globals, "nut", "A large sphere that rises in a shaken tank of small ones", 4000,
                               [spec](const ManyOptions& o) {
                                 spec->tank.spheres = o.spheres;
                                 return nut_scene(*spec, o.iterations, o.run.backend, o.run.threads);
                               });
  command->add_option("--seconds", spec->shaken, "Simulated time [s]")->check(CLI::Range(0.0, 1e4));
  command->footer("Example:\n  gonogo bench nut --spheres 4000 --seconds 10 --picture out/nut.png");
}

void add_ball(CLI::App& parent, const Globals& globals) {
  auto spec = std::make_shared<BallSpec>();
  CLI::App* command = add_many(parent, globals, "ball", "A light ball that floats on many smooth spheres", 20'000,
                               [spec](const ManyOptions& o) {
                                 spec->tank.spheres = o.spheres;
                                 return ball_scene(*spec, o.iterations, o.run.backend, o.run.threads);
                               });
  command->add_option("--density", spec->relative_density, "Of the ball over that of the bulk [-]")
      ->check(CLI::Range(0.01, 0.99));
  command->add_option("--ball", spec->size_ratio, "Diameter of the ball, in those of the spheres")
      ->check(CLI::Range(1.5, 1000.0));
  command->add_option("--seconds", spec->floated, "Simulated time [s]")->check(CLI::Range(0.0, 1e4));
  command->footer("Example:\n  gonogo bench ball --spheres 1000000 --ball 30 --backend cuda --picture out/ball.png");
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
  add_silo(bench, globals);
  add_collapse(bench, globals);
  add_crater(bench, globals);
  add_drum(bench, globals);
  add_nut(bench, globals);
  add_ball(bench, globals);
}

}  // namespace gonogo::pipeline::cli
