#include <map>
#include <memory>
#include <string>

#include "base/format.h"
#include "pipeline/app/lab/lab.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/lab/bench/engine_bench.h"
#include "pipeline/lab/bench/sampler_bench.h"
#include "sim/law/contact_law.h"

namespace gonogo::app {
namespace {

Json bed_json(const char* scene, const lab::BedBench& request, const lab::BedBenchResult& r) {
  Json json;
  json["scene"] = scene;
  json["backend"] = name_in(kBackends, request.backend);
  json["threads"] = request.threads;
  json["grain_diameter_m"] = request.grain_diameter;
  json["rolling_friction"] = request.rolling_friction;
  json["worlds"] = r.worlds;
  json["bodies"] = r.bodies;
  json["contacts"] = r.contacts;
  json["iterations"] = r.iterations;
  json["ms_per_step"] = r.ms_per_step;
  json["ns_per_contact_iteration"] = r.ns_per_contact_iteration;
  json["ns_per_contact_iteration_solver"] = r.ns_per_contact_iteration_solver;
  json["residual_m_per_s"] = r.residual_m_per_s;
  return json;
}

std::string bed_text(const char* scene, const lab::BedBenchResult& r) {
  return line(
      "%s: %d worlds, %lld bodies, %lld contacts, %d iterations: %.3f ms per step, %.3f ns per "
      "contact-iteration (whole step), %.3f ns (solver), residual %.2e m/s\n",
      scene, r.worlds, static_cast<long long>(r.bodies), static_cast<long long>(r.contacts), r.iterations,
      r.ms_per_step, r.ns_per_contact_iteration, r.ns_per_contact_iteration_solver, r.residual_m_per_s);
}

void print_bed(const Globals& globals, const char* scene, const lab::BedBench& request) {
  const lab::BedBenchResult r = lab::bench_bed(request);
  print_result(globals, bed_json(scene, request, r), bed_text(scene, r));
}

/// Times the batch and, `beside_one`, one world with as many grains. The ratio of the times is what many worlds cost.
void print_batch(const Globals& globals, const lab::BedBench& request, bool beside_one) {
  if (!beside_one) return print_bed(globals, "batch", request);
  lab::BedBench one = request;
  one.worlds = 1;
  one.copies = request.copies * request.worlds;
  const lab::BedBenchResult many = lab::bench_bed(request), single = lab::bench_bed(one);
  const double ratio = many.ns_per_contact_iteration / single.ns_per_contact_iteration;
  Json json = bed_json("batch", request, many);
  json["one_world"] = bed_json("batch", one, single);
  json["time_over_one_world"] = ratio;
  print_result(globals, json,
               bed_text("batch", many) + bed_text("one world", single) +
                   line("time of a contact-iteration over that in one world: %.3f\n", ratio));
}

/// Worlds as small as a settled bed can be.
void make_tiny(lab::BedBench& request) {
  request.worlds = 4096;
  request.length = request.width = 4.4 * request.grain_diameter;
  request.depth = 2 * request.grain_diameter;
}

void add_bed_options(CLI::App& command, lab::BedBench& request) {
  command.add_option("--grain", request.grain_diameter, "Grain diameter [m]")->check(CLI::Range(0.01, 0.2));
  command.add_option("--copies", request.copies, "Beds laid side by side into one world")->check(CLI::Range(1, 10000));
  command.add_option("--worlds", request.worlds, "Worlds in the batch")->check(CLI::Range(1, 100000));
  command.add_option("--iterations", request.iterations, "Solver iterations per step")->check(CLI::Range(2, 100000));
  command.add_option("--repeats", request.repeats, "Timed samples")->check(CLI::Range(3, 100000));
  command.add_option("--rolling", request.rolling_friction, "Rolling friction [-]")->check(CLI::Range(0.0, 10.0));
  add_choice(command, "--backend", request.backend, kBackends, "Device");
}

void add_bed(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("bed", "A settled bed of grains, 4 x 0.8 x 0.3 m, at rest");
  auto request = std::make_shared<lab::BedBench>();
  add_bed_options(*command, *request);
  add_examples(*command, {"gonogo bench bed --json  # one core; --threads 2 uses two"});
  command->callback([&globals, request] {
    request->threads = bench_threads(globals);
    request->packing_folder = campaign::default_packing_folder();
    print_bed(globals, "bed", *request);
  });
}

void add_batch(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("batch", "Many worlds with a settled bed of about 4,000 grains each");
  auto request = std::make_shared<lab::BedBench>();
  request->worlds = 512;
  request->length = 1.9;
  request->backend = sim::Backend::cuda;
  add_bed_options(*command, *request);
  command->add_option("--length", request->length, "Length of a world's bed [m]")->check(CLI::Range(0.2, 100.0));
  command->add_option("--width", request->width, "Width of a world's bed [m]")->check(CLI::Range(0.2, 100.0));
  command->add_option("--depth", request->depth, "Depth of a world's bed [m]")->check(CLI::Range(0.05, 10.0));
  auto tiny = std::make_shared<bool>(false), beside_one = std::make_shared<bool>(false);
  CLI::Option* sizes = command->add_flag("--tiny", *tiny, "4096 worlds of about 40 grains");
  for (const char* size : {"--worlds", "--length", "--width", "--depth"}) sizes->excludes(command->get_option(size));
  command->add_flag("--beside-one", *beside_one, "Time one world with as many grains, too");
  add_examples(*command, {"gonogo bench batch --beside-one --json  # 512 worlds, and one with as many grains",
                          "gonogo bench batch --tiny --beside-one --json  # 4096 worlds of about 40 grains, and one"});
  command->callback([&globals, request, tiny, beside_one] {
    request->threads = bench_threads(globals);
    request->packing_folder = campaign::default_packing_folder();
    if (*tiny) make_tiny(*request);
    print_batch(globals, *request, *beside_one);
  });
}

void print_wheel(const Globals& globals, const lab::WheelBench& request) {
  const lab::WheelBenchResult r = lab::bench_wheel(request);
  Json json;
  json["scene"] = "wheel";
  json["backend"] = name_in(kBackends, request.backend);
  json["threads"] = request.threads;
  json["solver"] = name_of(request.solver);
  json["target"] = sim::name_of(request.target);
  json["step_s"] = r.step;
  json["substeps"] = request.substeps;
  json["iterations"] = request.iterations;
  json["tolerance_m_per_s"] = request.tolerance;
  json["worlds"] = request.worlds;
  json["bodies"] = r.bodies;
  json["contacts"] = r.contacts;
  json["mean_iterations"] = r.mean_iterations;
  json["ms_per_step"] = r.ms_per_step;
  json["simulated_s_per_wall_s"] = r.simulated_per_wall;
  json["start_up_s"] = r.start_up;
  json["slip"] = r.slip;
  json["slip_standard_error"] = r.slip_error;
  json["sinkage_m"] = r.sinkage;
  json["torque_Nm"] = r.torque;
  json["residual_rms_m_per_s"] = r.residual_rms;
  json["residual_max_m_per_s"] = r.residual_max;
  print_result(
      globals, json,
      line("wheel: %d bodies, %d contacts, %.1f iterations: %.3f ms per step, %.2f simulated s per wall s, slip "
           "%.3f, sinkage %.4f m, residual %.2e m/s\n",
           r.bodies, r.contacts, r.mean_iterations, r.ms_per_step, r.simulated_per_wall, r.slip, r.sinkage,
           r.residual_rms));
}

void add_wheel(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("wheel", "A driven tyre on a bed of 32 mm grains up 15 degrees");
  auto request = std::make_shared<lab::WheelBench>();
  add_named(*command, "--scene", request->scene, kFile, "Scene file")->capture_default_str();
  CLI::Option* step = command->add_option("--step", request->step,
                                          "Time step [s]; with penalty contact by default 0.9 of the critical one");
  step->check(CLI::Range(1e-6, 1e-2));
  command->add_option("--overlap", request->overlap, "Penalty contact: overlap over radius in an impact at 2 m/s")
      ->check(CLI::Range(1e-5, 0.2));
  CLI::Option* substeps = command->add_option("--substeps", request->substeps, "Substeps of a step");
  substeps->check(CLI::Range(1, 1000));
  command->add_option("--iterations", request->iterations, "Max iterations of a substep")->check(CLI::Range(1, 100000));
  command->add_option("--tolerance", request->tolerance, "Residual at which the solver stops [m/s]; 0: never")
      ->check(CLI::Range(0.0, 10.0));
  command->add_option("--worlds", request->worlds, "Worlds in one batch; their wheels start at different places")
      ->check(CLI::Range(1, 100000));
  command->add_option("--drive-time", request->drive_time, "Time driven [s]; default: the scene's")
      ->check(CLI::Range(0.1, 1e3));
  add_choice(*command, "--backend", request->backend, kBackends, "Device");
  add_solver(*command, request->solver);
  std::map<std::string, sim::Target> targets;
  for (const std::string& name : sim::target_names()) targets[name] = sim::target_named(name);
  add_choice(*command, "--target", request->target, targets, "Cone program of the contacts");
  add_examples(*command, {"gonogo bench wheel --backend cuda --worlds 8 --json"});
  command->callback([&globals, request, step, substeps] {
    request->threads = bench_threads(globals);
    request->packing_folder = campaign::default_packing_folder();
    if (sim::is_penalty(request->solver.contact)) {
      if (step->count() == 0) request->step = 0;
      if (substeps->count() == 0) request->substeps = 1;
    }
    print_wheel(globals, *request);
  });
}

void print_gibbs(const Globals& globals, const lab::GibbsBench& request) {
  const lab::GibbsBenchResult r = lab::bench_gibbs(request);
  Json json;
  json["scene"] = "gibbs";
  json["backend"] = request.on_gpu ? "cuda" : "cpu";
  json["threads"] = request.threads;
  json["visible"] = Json(std::uint64_t(request.visible));
  json["hidden"] = Json(std::uint64_t(request.hidden));
  json["chains"] = Json(std::uint64_t(request.chains));
  json["sweeps"] = Json(std::uint64_t(request.sweeps));
  json["seconds"] = r.seconds;
  json["unit_updates_per_ns"] = r.updates_per_ns;
  json["mean_visible"] = r.mean_visible;
  print_result(globals, json,
               line("gibbs: %zu x %zu units, %zu chains, %zu sweeps: %.3f s, %.3f unit updates per ns\n",
                    request.visible, request.hidden, request.chains, request.sweeps, r.seconds, r.updates_per_ns));
}

void add_gibbs(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("gibbs", "Block Gibbs sampling of a restricted Boltzmann machine");
  auto request = std::make_shared<lab::GibbsBench>();
  auto backend = std::make_shared<sim::Backend>(sim::Backend::cpu);
  command->add_option("--visible", request->visible, "Visible units")->check(CLI::Range(1, 100000));
  command->add_option("--hidden", request->hidden, "Hidden units")->check(CLI::Range(1, 100000));
  command->add_option("--chains", request->chains, "Chains")->check(CLI::Range(1, 100000000));
  command->add_option("--sweeps", request->sweeps, "Sweeps of every chain")->check(CLI::Range(1, 1000000000));
  command->add_option("--repeats", request->repeats, "Timed samples")->check(CLI::Range(1, 100000));
  add_choice(*command, "--backend", *backend, kBackends, "Device");
  add_examples(*command, {"gonogo bench gibbs --backend cuda --chains 65536 --json"});
  command->callback([&globals, request, backend] {
    request->threads = bench_threads(globals);
    request->on_gpu = *backend == sim::Backend::cuda;
    print_gibbs(globals, *request);
  });
}

}  // namespace

void add_bench_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("bench", "Fixed scenes, timed");
  command->require_subcommand(1);
  add_examples(*command, {"gonogo bench bed --json"});
  add_bed(*command, globals);
  add_batch(*command, globals);
  add_wheel(*command, globals);
  add_gibbs(*command, globals);
  add_large_scenes(*command, globals);
  add_solver_bench(*command, globals);
}

}  // namespace gonogo::app
