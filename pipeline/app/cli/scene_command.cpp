#include "pipeline/app/cli/scene_command.h"

#include <cstdio>

#include "pipeline/lab/bench/timing.h"

namespace gonogo::app {
namespace {

Json watched_json(const std::vector<std::vector<lab::Measured>>& watched) {
  Json json;
  for (std::size_t k = 0; k < watched.front().size(); ++k) {
    std::vector<double> values;
    for (const std::vector<lab::Measured>& look : watched) values.push_back(look[k].value);
    json[watched.front()[k].key] = values;
  }
  return json;
}

std::string watched_text(const std::vector<std::vector<lab::Measured>>& watched) {
  std::string text;
  char cell[40];
  for (const lab::Measured& m : watched.front()) {
    std::snprintf(cell, sizeof cell, "  %18s", m.key.c_str());
    text += cell;
  }
  for (const std::vector<lab::Measured>& look : watched) {
    text += '\n';
    for (const lab::Measured& m : look) {
      std::snprintf(cell, sizeof cell, "  %18.4g", m.value);
      text += cell;
    }
  }
  return text + '\n';
}

Json scene_json(const lab::ManyScene& scene, const lab::ManyRun& run, Index spheres, const lab::ManyResult& r,
                double made) {
  Json json = counts_json(scene.name, run.on, spheres, r.bodies, r.contacts);
  json["solver"] = name_in(kSolvers, scene.settings.solver);
  json["iterations"] = r.iterations;
  for (const lab::Measured& m : r.measured) json[m.key] = m.value;
  if (!r.watched.empty()) json["watched"] = watched_json(r.watched);
  json["step_s"] = scene.settings.step;
  json["simulated_s"] = scene.duration;
  json["residual_m_per_s"] = r.residual_m_per_s;
  json["made_s"] = made + r.build_seconds;
  json["run_s"] = r.run_seconds;
  if (run.repeats == 0) return json;
  json["ms_per_step"] = r.ms_per_step;
  json["stages_ms"] = stages_json(r.stages, sim::Stage::bins, sim::Stage::integrate);
  json["ns_per_contact_iteration"] = r.ns_per_contact_iteration;
  json["ns_per_contact_iteration_solver"] = r.ns_per_contact_iteration_solver;
  json["copy_bandwidth_B_per_s"] = r.copy_bandwidth;
  json["solver_share_of_copy_bandwidth"] = r.bandwidth_share;
  return json;
}

std::string scene_text(const lab::ManyScene& scene, const lab::ManyRun& run, const lab::ManyResult& r, double made) {
  char line[300];
  std::snprintf(line, sizeof line,
                "%s: %lld bodies, %lld contacts, residual %.2e m/s; made in %.1f s, %.2f s simulated in %.1f s\n",
                scene.name.c_str(), static_cast<long long>(r.bodies), static_cast<long long>(r.contacts),
                r.residual_m_per_s, made + r.build_seconds, scene.duration, r.run_seconds);
  std::string text = line;
  for (const lab::Measured& m : r.measured) {
    std::snprintf(line, sizeof line, "  %-26s %10.4g\n", m.key.c_str(), m.value);
    text += line;
  }
  if (!r.watched.empty()) text += watched_text(r.watched);
  if (run.repeats == 0) return text;
  std::snprintf(
      line, sizeof line,
      "%s, %d iterations: %.3f ms per step, %.3f ns per contact-iteration (whole step), %.3f ns (solver), %.2f of "
      "the copy bandwidth\n",
      name_in(kSolvers, scene.settings.solver).c_str(), r.iterations, r.ms_per_step, r.ns_per_contact_iteration,
      r.ns_per_contact_iteration_solver, r.bandwidth_share);
  return text + line + stages_text(r.stages, sim::Stage::bins, sim::Stage::integrate);
}

}  // namespace

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

Json counts_json(const std::string& scene, const lab::RunOn& on, std::int64_t spheres, std::int64_t bodies,
                 std::int64_t contacts) {
  Json json;
  json["scene"] = scene;
  json["backend"] = name_in(kBackends, on.backend);
  json["threads"] = on.threads;
  json["spheres"] = spheres;
  json["bodies"] = bodies;
  json["contacts"] = contacts;
  json["contacts_per_sphere"] = double(contacts) / double(spheres);
  return json;
}

void add_sphere_count(CLI::App& command, Index& count) {
  command.add_option("--spheres", count, "Number of spheres")
      ->check(CLI::Range(100, 100'000'000))
      ->capture_default_str();
}

void add_friction(CLI::App& command, lab::Spheres& of, const std::string& of_what) {
  command.add_option("--friction", of.friction, "Friction of " + of_what + " [-]")->check(CLI::Range(0.0, 10.0));
}

CLI::App* add_scene(CLI::App& parent, const Globals& globals, const char* name, const char* about, Index* count,
                    const std::function<lab::ManyScene(const lab::RunOn&)>& make) {
  CLI::App* command = parent.add_subcommand(name, about);
  const auto run = std::make_shared<lab::ManyRun>();
  add_sphere_count(*command, *count);
  add_solver(*command, run->on.solver);
  command->add_option("--iterations", run->on.iterations, "Solver iterations per step")->check(CLI::Range(1, 100000));
  command->add_option("--overlap", run->softness.overlap, "Penalty contact: overlap over radius after the world's fall")
      ->check(CLI::Range(1e-5, 0.2))
      ->capture_default_str();
  command->add_option("--restitution", run->softness.restitution, "Penalty contact: restitution [-]")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command->add_option("--repeats", run->repeats, "Timed samples at the end; 0: none")->check(CLI::Range(0, 100000));
  command->add_option("--vtk", run->vtk, "Folder for VTK files that ParaView opens")->type_name(kFolder);
  command->add_option("--every", run->every, "Time between two frames [s]")->check(CLI::Range(1e-3, 1e3));
  command->add_option("--picture", run->picture, "PNG of the end; walls and floors are left out")->type_name(kFile);
  command->add_option("--video", run->video, "MP4 of the run, made by ffmpeg; walls and floors are left out")
      ->type_name(kFile);
  command->add_option("--plot", run->plot, "PNG of the scene's quantities over time, where it has any")
      ->type_name(kFile);
  add_choice(*command, "--backend", run->on.backend, kBackends, "Device");
  command->callback([&globals, run, count, make] {
    run->on.threads = bench_threads(globals);
    sim::require_backend(run->on.backend);
    const double start = lab::seconds();
    lab::ManyScene scene = make(run->on);
    lab::set_penalty(scene, run->softness);
    const double made = lab::seconds() - start;
    const lab::ManyResult r = lab::run_many(scene, *run);
    print_result(globals, scene_json(scene, *run, *count, r, made), scene_text(scene, *run, r, made));
  });
  return command;
}

}  // namespace gonogo::app
