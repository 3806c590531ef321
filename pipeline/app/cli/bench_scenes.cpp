#include <cstdio>

#include "base/shipped.h"
#include "pipeline/app/cli/scene_command.h"
#include "pipeline/lab/scenes/ball.h"
#include "pipeline/lab/scenes/collapse.h"
#include "pipeline/lab/scenes/collide.h"
#include "pipeline/lab/scenes/crater.h"
#include "pipeline/lab/scenes/drum.h"
#include "pipeline/lab/scenes/nut.h"
#include "pipeline/lab/scenes/pebbles.h"
#include "pipeline/lab/scenes/screen.h"
#include "pipeline/lab/scenes/silo.h"

namespace gonogo::app {
namespace {

constexpr const char* kAll = "spheres and walls";

void print_collide(const Globals& globals, const lab::CollideBench& request) {
  const lab::CollideBenchResult r = lab::bench_collide(request);
  Json json = counts_json("collide", request.on, request.tank.of.count, r.bodies, r.contacts);
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

void add_tank(CLI::App& parent, const Globals& globals) {
  const auto spec = std::make_shared<lab::TankSpec>();
  CLI::App* command = add_scene(parent, globals, "tank", "A shaken tank of spheres, about 3.6 contacts each", spec,
                                spec->of, lab::shaken_tank);
  add_friction(*command, spec->of, kAll);
  command->add_option("--seconds", spec->seconds, "Time shaken before anything is timed [s]")
      ->check(CLI::Range(0.0, 1e4))
      ->capture_default_str();
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
  command->add_option("--vehicle", *vehicle, "Tracked vehicle")->type_name(kVehicle);
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
