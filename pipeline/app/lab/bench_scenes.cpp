#include <memory>
#include <string>

#include "base/files/shipped.h"
#include "base/format.h"
#include "pipeline/app/lab/lab.h"
#include "pipeline/lab/scenes/collapse.h"
#include "pipeline/lab/scenes/drum.h"
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/screen.h"
#include "pipeline/lab/scenes/silo.h"
#include "pipeline/lab/scenes/tank.h"

namespace gonogo::app {
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
    text += line("  %-10s %10.3f ms\n", sim::kStageNames[k], times.seconds[k] * 1e3);
  }
  return text;
}

/// The first entries of every scene's result.
Json scene_counts(const std::string& scene, const lab::RunOn& on, std::int64_t spheres, std::int64_t bodies,
                  std::int64_t contacts) {
  Json json;
  json["scene"] = scene;
  json["backend"] = name_in(kBackends, on.backend);
  json["threads"] = on.threads;
  if (on.gpus > 1) json["gpus"] = on.gpus;
  json["spheres"] = spheres;
  json["bodies"] = bodies;
  json["contacts"] = contacts;
  json["contacts_per_sphere"] = double(contacts) / double(spheres);
  return json;
}

Json watched_json(const std::vector<std::vector<lab::SceneNumber>>& watched) {
  Json json;
  for (std::size_t k = 0; k < watched.front().size(); ++k) {
    std::vector<double> values;
    for (const std::vector<lab::SceneNumber>& look : watched) values.push_back(look[k].value);
    json[watched.front()[k].key] = values;
  }
  return json;
}

std::string watched_text(const std::vector<std::vector<lab::SceneNumber>>& watched) {
  std::string text;
  for (const lab::SceneNumber& m : watched.front()) {
    text += line("  %18s", m.key.c_str());
  }
  for (const std::vector<lab::SceneNumber>& look : watched) {
    text += '\n';
    for (const lab::SceneNumber& m : look) {
      text += line("  %18.4g", m.value);
    }
  }
  return text + '\n';
}

Json scene_json(const lab::ManyScene& scene, const lab::ManyRun& run, Index spheres, const lab::ManyResult& r,
                double made) {
  Json json = scene_counts(scene.name, run.on, spheres, r.bodies, r.contacts);
  json["solver"] = name_of(scene.settings.method());
  json["iterations"] = r.iterations;
  for (const lab::SceneNumber& m : r.measured) json[m.key] = m.value;
  if (!r.watched.empty()) json["watched"] = watched_json(r.watched);
  json["step_s"] = scene.settings.step;
  json["simulated_s"] = scene.duration;
  json["residual_m_per_s"] = r.residual_m_per_s;
  json["made_s"] = made + r.build_seconds;
  json["run_s"] = r.run_seconds;
  if (run.repeats == 0) return json;
  json["ms_per_step"] = r.ms_per_step;
  json["ns_per_contact_iteration"] = r.ns_per_contact_iteration;
  if (run.on.gpus > 1) return json;
  json["stages_ms"] = stages_json(r.stages, sim::Stage::bins, sim::Stage::integrate);
  json["ns_per_contact_iteration_solver"] = r.ns_per_contact_iteration_solver;
  json["copy_bandwidth_B_per_s"] = r.copy_bandwidth;
  json["solver_share_of_copy_bandwidth"] = r.bandwidth_share;
  return json;
}

std::string scene_text(const lab::ManyScene& scene, const lab::ManyRun& run, const lab::ManyResult& r, double made) {
  std::string text =
      line("%s: %lld bodies, %lld contacts, residual %.2e m/s; made in %.1f s, %.2f s simulated in %.1f s\n",
           scene.name.c_str(), static_cast<long long>(r.bodies), static_cast<long long>(r.contacts), r.residual_m_per_s,
           made + r.build_seconds, scene.duration, r.run_seconds);
  for (const lab::SceneNumber& m : r.measured) text += line("  %-26s %10.4g\n", m.key.c_str(), m.value);
  if (!r.watched.empty()) text += watched_text(r.watched);
  if (run.repeats == 0) return text;
  if (run.on.gpus > 1)
    return text + line("%s on %d GPUs, %d iterations: %.3f ms per step, %.3f ns per contact-iteration (whole step)\n",
                       name_of(scene.settings.method()), run.on.gpus, r.iterations, r.ms_per_step,
                       r.ns_per_contact_iteration);
  return text +
         line(
             "%s, %d iterations: %.3f ms per step, %.3f ns per contact-iteration (whole step), %.3f ns (solver), %.2f "
             "of "
             "the copy bandwidth\n",
             name_of(scene.settings.method()), r.iterations, r.ms_per_step, r.ns_per_contact_iteration,
             r.ns_per_contact_iteration_solver, r.bandwidth_share) +
         stages_text(r.stages, sim::Stage::bins, sim::Stage::integrate);
}

void add_sphere_count(CLI::App& command, Index& count) {
  add_number(command, "--spheres", count, {100, 100'000'000}, "Number of spheres");
}

void add_friction(CLI::App& command, lab::Spheres& of, const std::string& of_what) {
  command.add_option("--friction", of.friction, "Friction of " + of_what + " [-]")->check(CLI::Range(0.0, 10.0));
}

/// A subcommand that makes a scene, runs, shows and times it, and prints what it measures. `count`: number of spheres,
/// which must live as long as `make`.
CLI::App* add_scene(CLI::App& parent, const Globals& globals, const char* name, const char* about, Index* count,
                    const std::function<lab::ManyScene(const lab::RunOn&)>& make) {
  CLI::App* command = parent.add_subcommand(name, about);
  const auto run = std::make_shared<lab::ManyRun>();
  add_sphere_count(*command, *count);
  add_solver(*command, run->on.solver);
  command->add_option("--iterations", run->on.iterations, "Solver iterations per step")->check(CLI::Range(1, 100000));
  add_number(*command, "--overlap", run->softness.overlap, {1e-5, 0.2},
             "Penalty contact: overlap over radius after the world's fall");
  add_number(*command, "--restitution", run->softness.restitution, {0.01, 1.0}, "Penalty contact: restitution [-]");
  command->add_option("--repeats", run->repeats, "Timed samples at the end; 0: none")->check(CLI::Range(0, 100000));
  add_named(*command, "--vtk", run->vtk, kFolder, "Folder for VTK files that ParaView opens");
  command->add_option("--every", run->every, "Time between two frames [s]")->check(CLI::Range(1e-3, 1e3));
  add_named(*command, "--picture", run->picture, kFile, "PNG of the end; walls and floors are left out");
  add_named(*command, "--video", run->video, kFile, "MP4 of the run, made by ffmpeg; walls and floors are left out");
  add_named(*command, "--plot", run->plot, kFile, "PNG of the scene's quantities over time, where it has any");
  add_choice(*command, "--backend", run->on.backend, kBackends, "Device");
  command->add_option("--gpus", run->on.gpus, "Number of GPUs over which the world is divided")
      ->check(CLI::Range(1, 8));
  command->callback([&globals, run, count, make] {
    if (run->on.gpus > 1) run->on.backend = sim::Backend::cuda;
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

/// The same for a scene that `make` builds from a spec with the spheres `of`.
template <class Spec>
CLI::App* add_scene(CLI::App& parent, const Globals& globals, const char* name, const char* about,
                    const std::shared_ptr<Spec>& spec, lab::Spheres& of,
                    lab::ManyScene (*make)(const Spec&, const lab::RunOn&)) {
  return add_scene(parent, globals, name, about, &of.count,
                   [spec, make](const lab::RunOn& on) { return make(*spec, on); });
}

constexpr const char* kAll = "spheres and walls";

void print_collide(const Globals& globals, const lab::CollideBench& request) {
  const lab::CollideBenchResult r = lab::bench_collide(request);
  Json json = scene_counts("collide", request.on, request.tank.of.count, r.bodies, r.contacts);
  json["ms_per_search"] = r.ms_per_search;
  json["stages_ms"] = stages_json(r.stages, sim::Stage::bins, sim::Stage::contacts);
  json["ns_per_contact"] = r.ns_per_contact;
  json["build_s"] = r.build_seconds;
  print_result(globals, json,
               line("collide: %lld bodies, %lld contacts: %.3f ms per search, %.3f ns per contact; made in %.1f s\n",
                    static_cast<long long>(r.bodies), static_cast<long long>(r.contacts), r.ms_per_search,
                    r.ns_per_contact, r.build_seconds) +
                   stages_text(r.stages, sim::Stage::bins, sim::Stage::contacts));
}

void add_tank(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::TankSpec>();
  CLI::App* command = add_scene(parent, globals, "tank", "A shaken tank of spheres, about 3.6 contacts each", spec,
                                spec->of, lab::shaken_tank);
  add_friction(*command, spec->of, kAll);
  add_number(*command, "--seconds", spec->seconds, {0.0, 1e4}, "Time shaken before anything is timed [s]");
  add_examples(*command, {"gonogo bench tank --spheres 1000000 --backend cuda --json"});
}

void add_silo(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::SiloSpec>();
  CLI::App* command = add_scene(parent, globals, "silo", "A silo with a flat floor, filled and opened", spec, spec->of,
                                lab::silo_scene);
  add_friction(*command, spec->of, kAll);
  command->add_option("--rolling", spec->rolling_friction, "Rolling friction of spheres and walls [-]")
      ->check(CLI::Range(0.0, 10.0));
  command->add_option("--orifice", spec->orifice_diameters, "Hole, in sphere diameters; 0: a third of the silo's width")
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--flow-time", spec->flow_time, "Time simulated after the opening [s]")
      ->check(CLI::Range(0.01, 1e4));
  command->add_option("--slenderness", spec->slenderness, "Height of the fill over the silo's width, about")
      ->check(CLI::Range(0.2, 20.0));
  add_examples(*command, {"gonogo bench silo --spheres 128000 --backend cuda --json"});
}

void add_collapse(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::CollapseSpec>();
  CLI::App* command = add_scene(parent, globals, "collapse", "A round column that falls apart when its wall is gone",
                                spec, spec->of, lab::collapse_scene);
  add_friction(*command, spec->of, "spheres and floor");
  command->add_option("--aspect", spec->aspect, "Height of the column over its radius, about")
      ->check(CLI::Range(0.1, 20.0));
  command->add_option("--rolling", spec->rolling_friction, "Rolling friction [-]")->check(CLI::Range(0.0, 10.0));
  command->add_option("--seed", spec->of.seed, "Seed of the spheres' sizes and places")
      ->check(kSeed)
      ->capture_default_str();
  add_examples(*command, {"gonogo bench collapse --aspect 1 --picture out/collapse.png"});
}

void add_crater(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::CraterSpec>();
  CLI::App* command = add_scene(parent, globals, "crater", "A ball dropped onto a bed of spheres", spec, spec->tank.of,
                                lab::crater_scene);
  add_friction(*command, spec->tank.of, kAll);
  command->add_option("--height", spec->drop_height, "Height from which it falls [m]")->check(CLI::Range(0.0, 100.0));
  command->add_option("--ball", spec->size_ratio, "Diameter of the ball, in those of the spheres")
      ->check(CLI::Range(1.5, 1000.0));
  add_examples(*command, {"gonogo bench crater --height 1.6 --picture out/crater.png"});
}

void add_drum(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::DrumSpec>();
  CLI::App* command = add_scene(parent, globals, "drum", "Spheres of two materials that a turning drum mixes", spec,
                                spec->of, lab::drum_scene);
  add_friction(*command, spec->of, "the first material");
  command->add_option("--other-friction", spec->other_friction, "Friction of the second material and the rim [-]")
      ->check(CLI::Range(0.0, 10.0));
  command->add_option("--turns", spec->turns, "Turns of the drum")->check(CLI::Range(0.0, 1000.0));
  add_examples(*command, {"gonogo bench drum --spheres 16000 --turns 4 --plot out/mixing.png"});
}

void add_nut(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::NutSpec>();
  CLI::App* command = add_scene(parent, globals, "nut", "A large sphere that rises in a shaken tank of small ones",
                                spec, spec->tank.of, lab::nut_scene);
  add_friction(*command, spec->tank.of, kAll);
  command->add_option("--seconds", spec->shaken, "Simulated time [s]")->check(CLI::Range(0.0, 1e4));
  add_examples(*command, {"gonogo bench nut --spheres 4000 --seconds 10 --picture out/nut.png"});
}

void add_ball(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::BallSpec>();
  CLI::App* command = add_scene(parent, globals, "ball", "A light ball that floats on many smooth spheres", spec,
                                spec->tank.of, lab::ball_scene);
  command->add_option("--density", spec->relative_density, "Density of the ball over that of the bulk [-]")
      ->check(CLI::Range(0.01, 0.99));
  command->add_option("--ball", spec->size_ratio, "Diameter of the ball, in those of the spheres")
      ->check(CLI::Range(1.5, 1000.0));
  command->add_option("--seconds", spec->floated, "Simulated time [s]")->check(CLI::Range(0.0, 1e4));
  add_examples(*command, {"gonogo bench ball --spheres 1000000 --ball 30 --backend cuda --picture out/ball.png"});
}

void add_screen(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::ScreenSpec>();
  CLI::App* command = add_scene(parent, globals, "screen", "A screen, shaken by crank and rod, that sorts by size",
                                spec, spec->of, lab::screen_scene);
  add_friction(*command, spec->of, "spheres and machine");
  command->add_option("--large", spec->large_share, "Share of large spheres in the feed's volume [-]")
      ->check(CLI::Range(0.05, 0.95));
  command->add_option("--throw", spec->throw_number, "Largest acceleration at right angles to the deck [g]")
      ->check(CLI::Range(0.0, 10.0));
  command->add_option("--seconds", spec->shaken, "Time shaken [s]")->check(CLI::Range(0.0, 1e4));
  add_examples(*command, {"gonogo bench screen --spheres 3000 --plot out/screening.png --video out/screen.mp4"});
}

void add_pebbles(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::PebblesSpec>();
  const auto vehicle = std::make_shared<std::string>("m113");
  lab::Spheres& of = spec->tank.of;
  CLI::App* command = add_scene(parent, globals, "pebbles", "A tracked vehicle, shoe by shoe, that drives over pebbles",
                                &of.count, [spec, vehicle](const lab::RunOn& on) {
                                  spec->vehicle = shipped_file("vehicles", "vehicle", *vehicle);
                                  return lab::pebbles_scene(*spec, on);
                                });
  add_friction(*command, of, "pebbles");
  add_named(*command, "--vehicle", *vehicle, kVehicle, "Tracked vehicle");
  command->add_option("--diameter", of.diameter, "Mean diameter of the pebbles [m]")->check(CLI::Range(0.01, 0.3));
  command->add_option("--rolling", spec->rolling_friction, "Rolling friction of the pebbles [-]")
      ->check(CLI::Range(0.0, 10.0));
  command->add_option("--layers", spec->tank.layers, "Layers of pebbles")->check(CLI::Range(2, 100));
  command->add_option("--speed", spec->speed, "Speed that the driver holds [m/s]")->check(CLI::Range(0.1, 10.0));
  command->add_option("--seconds", spec->driven, "Time driven [s]")->check(CLI::Range(0.0, 100.0));
  add_examples(*command, {"gonogo bench pebbles --plot out/drive.png --video out/pebbles.mp4 --repeats 0"});
}

void add_collide(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("collide", "The search for contacts alone, in the same tank at rest");
  auto request = std::make_shared<lab::CollideBench>();
  add_sphere_count(*command, request->tank.of.count);
  command->add_option("--repeats", request->repeats, "Timed samples")->check(CLI::Range(3, 100000));
  add_choice(*command, "--backend", request->on.backend, kBackends, "Device");
  add_examples(*command, {"gonogo bench collide --spheres 6100000 --backend cuda --json  # 22 million contacts"});
  command->callback([&globals, request] {
    request->on.threads = bench_threads(globals);
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
  add_screen(bench, globals);
  add_pebbles(bench, globals);
  add_nut(bench, globals);
  add_ball(bench, globals);
}

}  // namespace gonogo::app
