#include <cmath>
#include <memory>

#include "base/cancel.h"
#include "base/line.h"
#include "pipeline/app/cli/bench_parts.h"
#include "pipeline/lab/solver_bench/solver_bench.h"
#include "pipeline/lab/validate/fclib.h"
#include "sim/scene/target_name.h"

namespace gonogo::app {
namespace {

struct SolversRequest {
  std::vector<std::string> paths, solvers = {"nsgs", "apgd", "admm", "pdip", "ppa"};
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

void run_bench(const Globals& globals, SolversRequest request) {
  lab::SolverBench& bench = request.bench;
  bench.files = lab::fclib_files({request.paths.begin(), request.paths.end()});
  bench.settings.target = sim::target_named(request.target);
  for (const std::string& name : request.solvers) bench.solvers.push_back(sim::local_solver(name));
  const auto runs = lab::bench_solvers(bench, [] { stop_if_cancelled(); });
  std::string text = table_head(bench);
  Json rows = Json::array();
  for (const lab::SolverRun& run : runs) {
    text += run_text(bench, run);
    rows.push_back(run_json(bench, run));
  }
  Json json;
  json["target"] = request.target;
  json["tolerances"] = Json(bench.tolerances);
  json["runs"] = rows;
  if (!request.out.empty()) {
    lab::write_solver_bench(request.out, bench, runs);
    json["folder"] = request.out;
  }
  print_result(globals, json, text);
}

}  // namespace

void add_solver_bench(CLI::App& bench, const Globals& globals) {
  CLI::App* command =
      bench.add_subcommand("solvers", "Reference solvers on contact problems from files, at equal error");
  const auto request = std::make_shared<SolversRequest>();
  command->add_option("paths", request->paths, "Problem files, or folders of them (.hdf5, .dat)")
      ->type_name(kFile)
      ->required();
  command->add_option("--solver", request->solvers, "Solvers as for gonogo validate fclib, separated by commas")
      ->check(CLI::IsMember(sim::solver_names()))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command->add_option("--target", request->target, "coulomb, or ccp: its convex relaxation")
      ->check(CLI::IsMember(sim::target_names()))
      ->capture_default_str();
  command->add_option("--tolerance", request->bench.tolerances, "Errors to reach, falling, separated by commas")
      ->check(CLI::Range(1e-15, 1.0))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command
      ->add_option("--iterations", request->bench.settings.max_iterations, "Max iterations; 0: the solver's own limit")
      ->check(CLI::Range(0, 100000000))
      ->capture_default_str();
  command->add_option("--out", request->out, "Folder for convergence curves and performance profiles, as CSV and PNG")
      ->type_name(kFolder);
  add_examples(*command, {"gonogo bench solvers tests/data/fclib --out out/solvers",
                          "gonogo bench solvers tests/data/fclib --target ccp --solver apgd,nesterov,pdip,minres"});
  command->callback([&globals, request] { run_bench(globals, *request); });
}

}  // namespace gonogo::app
