#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/app/lab/lab.h"
#include "pipeline/lab/bench/solver_figures.h"
#include "sim/law/contact_law.h"

namespace gonogo::app {
namespace {

/// Solvers of the cone program; springs have no residual to compare.
std::vector<std::string> cone_solvers() {
  std::vector<std::string> names;
  for (const auto& [name, solver] : kSolvers)
    if (!sim::is_penalty(solver.contact)) names.push_back(name);
  return names;
}

struct SolversRequest {
  std::vector<std::string> paths, solvers = {"nsgs", "apgd", "admm", "pdip", "ppa"}, engine, scenes;
  std::vector<int> bodies = {10, 100, 1000};
  std::string target = "coulomb", out;
  lab::SolverBench bench;
};

Json run_json(const lab::SolverBench& bench, const lab::SolverRun& run) {
  Json json;
  json["problem"] = run.problem;
  json["contacts"] = run.contacts;
  json["solver"] = run.solver;
  json["iterations"] = run.iterations;
  json["error"] = run.error;
  if (!run.refusal.empty()) json["refused"] = run.refusal;
  if (run.lcp_error > 0) json["lcp_error"] = run.lcp_error;
  if (!run.scene.empty()) {
    json["scene"] = run.scene;
    json["bodies"] = run.bodies;
    json["kinetic_energy_J"] = run.motion.kinetic_energy;
  }
  Json seconds = Json::array();
  for (const double tolerance : bench.tolerances) {
    const double taken = run.seconds_to(tolerance);
    seconds.push_back(std::isfinite(taken) ? Json(taken) : Json());
  }
  json["seconds_to_tolerances"] = seconds;
  return json;
}

std::string run_text(const lab::SolverBench& bench, const lab::SolverRun& run) {
  if (!run.refusal.empty()) return run.problem + ": " + run.refusal + "\n";
  std::string text = line("%-34s %8d  %-12s %10d %10.2e", run.problem.c_str(), run.contacts, run.solver.c_str(),
                          run.iterations, run.error);
  for (const double tolerance : bench.tolerances) {
    const double ms = 1000 * run.seconds_to(tolerance);
    text += std::isfinite(ms) ? line(" %12.2f", ms) : "            -";
  }
  return text + "\n";
}

std::string table_head(const lab::SolverBench& bench) {
  std::string text = "problem                            contacts  solver       iterations      error";
  for (const double tolerance : bench.tolerances) text += line("  ms to %.0e", tolerance);
  return text + "\n";
}

/// Empty without scenes.
std::string growth_text(const lab::SolverBench& bench, const std::vector<lab::SolverRun>& runs) {
  std::string text;
  for (const lab::Growth& g : lab::growth(bench, runs)) {
    if (g.sizes < 2) continue;
    if (text.empty()) text = "scene      solver              error  sizes  time ~ bodies^  iterations ~ bodies^\n";
    text += line("%-10s %-16s %8.0e %6d %15.2f %21.2f\n", g.scene.c_str(), g.solver.c_str(), g.tolerance, g.sizes,
                 g.seconds_exponent, g.iterations_exponent);
  }
  return text;
}

/// Rows and tables of the runs as they end, under one progress line.
class BenchRows {
 public:
  BenchRows(const Globals& globals, const SolversRequest& request)
      : globals_(globals), request_(request), progress_("bench solvers", "runs", lab::run_count(request.bench)) {}

  lab::SolverBenchWatch watch() {
    return {.begins = [this](const std::string& what) { progress_.update(runs_.size(), what); },
            .ended = [this](const lab::SolverRun& run) { add(run); }};
  }
  Json json() const {
    Json rows = Json::array();
    for (const lab::SolverRun& run : runs_) rows.push_back(run_json(request_.bench, run));
    return rows;
  }
  void finish() {
    progress_.update(runs_.size());
    progress_.finish();
  }

  /// Keeps what has ended. `times.csv` is there already.
  [[noreturn]] void stop() {
    finish();
    std::string kept = "interrupted; the runs that ended are in the rows above; --out FOLDER would keep them";
    if (!request_.out.empty()) {
      lab::write_solver_curves(request_.out, runs_);
      kept = line("interrupted; times.csv and curves.csv in %s hold the %zu runs that ended", request_.out.c_str(),
                  runs_.size());
    }
    throw Cancelled(kept);
  }

 private:
  void add(const lab::SolverRun& run) {
    progress_.make_room();
    print_row(globals_, (runs_.empty() ? table_head(request_.bench) : "") + run_text(request_.bench, run));
    runs_.push_back(run);
    if (!request_.out.empty()) lab::write_solver_times(request_.out, request_.bench, runs_);
  }

  const Globals& globals_;
  const SolversRequest& request_;
  Progress progress_;
  std::vector<lab::SolverRun> runs_;
};

std::vector<lab::SolverRun> run_all(const SolversRequest& request, BenchRows& rows) {
  try {
    return lab::bench_solvers(request.bench, rows.watch());
  } catch (const Cancelled&) {
    rows.stop();
  }
}

void run_bench(const Globals& globals, SolversRequest request) {
  lab::SolverBench& bench = request.bench;
  if (request.paths.empty() && request.scenes.empty())
    throw InputError("bench solvers: neither a problem file nor a scene is given; name a path or --scene filling");
  if (!request.paths.empty()) bench.files = lab::fclib_files({request.paths.begin(), request.paths.end()});
  for (const std::string& name : request.scenes) bench.scenes.push_back({lab::step_scene(name), request.bodies});
  bench.threads = bench_threads(globals);
  sim::require_backend(bench.backend);
  bench.settings.target = sim::target_named(request.target);
  for (const std::string& name : request.solvers) bench.solvers.push_back(sim::local_solver(name));
  for (const std::string& name : request.engine) bench.engine_solvers.push_back(kSolvers.at(name).iteration);
  BenchRows rows(globals, request);
  const auto runs = run_all(request, rows);
  rows.finish();
  Json json;
  json["target"] = request.target;
  json["tolerances"] = Json(bench.tolerances);
  json["runs"] = rows.json();
  if (!request.out.empty()) {
    lab::write_solver_bench(request.out, bench, runs);
    json["folder"] = request.out;
  }
  print_result(globals, json, growth_text(bench, runs));
}

}  // namespace

void add_solver_bench(CLI::App& bench, const Globals& globals) {
  CLI::App* command =
      bench.add_subcommand("solvers", "Solvers of contact problems from files and scenes, at equal error");
  const auto request = std::make_shared<SolversRequest>();
  add_named(*command, "paths", request->paths, kFile, "Problem files, or folders of them (.hdf5, .dat)");
  add_list(*command, "--scene", request->scenes,
           "Scenes whose steps are solved: " + join_words(lab::step_scene_names()))
      ->check(CLI::IsMember(lab::step_scene_names()));
  add_list(*command, "--bodies", request->bodies, "Numbers of bodies of each scene, growing")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  add_list(*command, "--engine", request->engine, "The engine's own solvers on scenes, from a cold start")
      ->check(CLI::IsMember(cone_solvers()));
  add_choice(*command, "--backend", request->bench.backend, kBackends,
             "Of the engine, which also settles the scenes; cuda: its times are by the clock");
  command->add_flag("--warm", request->bench.is_warm, "nsgs, apgd and anderson start from the step before");
  add_number(*command, "--skip-after", request->bench.skip_after, {0.001, 1e6},
             "A solver that took longer at some size is not run at larger ones [s]");
  add_number(*command, "--whole", request->bench.most_whole, {0, 100000000},
             "Scenes whose matrix W has more blocks are solved without it, with products by bodies");
  add_reference_solvers(*command, request->solvers, request->target);
  add_list(*command, "--tolerance", request->bench.tolerances, "Errors to reach, falling")
      ->check(CLI::Range(1e-15, 1.0))
      ->capture_default_str();
  add_number(*command, "--iterations", request->bench.settings.max_iterations, {0, 100000000},
             "Max iterations; 0: the solver's own limit");
  add_named(*command, "--out", request->out, kFolder,
            "Folder for convergence curves and performance profiles, as CSV and PNG");
  add_examples(*command,
               {"gonogo bench solvers tests/data/fclib --out out/solvers",
                "gonogo bench solvers tests/data/fclib --target ccp --solver apgd,nesterov,pdip,minres",
                "gonogo bench solvers --scene filling --bodies 100,1000 --target ccp --solver apgd,pdip_bodies"});
  command->callback([&globals, request] { run_bench(globals, *request); });
}

}  // namespace gonogo::app
