#include "pipeline/lab/solver_bench/solver_bench.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/cancel.h"
#include "base/error.h"
#include "base/format.h"
#include "pipeline/lab/solver_bench/engine_runs.h"
#include "sim/local_problem/read.h"

namespace gonogo::lab {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

template <class Value>
double first_at(const SolverRun& run, double tolerance, Value value) {
  for (const sim::TracePoint& point : run.trace)
    if (point.error <= tolerance) return value(point);
  return kNever;
}

SolverRun run_solver(const std::string& name, const sim::LocalProblem& problem, sim::LocalSolveSettings settings,
                     const sim::StepProblem* step) {
  settings.keeps_trace = true;
  const sim::LocalSolution x = sim::solve(problem, settings);
  SolverRun run{.problem = name,
                .solver = sim::solver_name(settings.solver),
                .refusal = x.refusal,
                .contacts = problem.contact_count(),
                .iterations = x.iterations,
                .error = x.error,
                .lcp_error = x.lcp_error,
                .linear = x.linear,
                .trace = x.trace};
  if (step) run.motion = step->motion(x.r);
  return run;
}

void check(const SolverBench& bench) {
  for (std::size_t k = 0; k + 1 < bench.tolerances.size(); ++k)
    if (!(bench.tolerances[k] > bench.tolerances[k + 1])) throw InputError("tolerances must fall, from coarse to fine");
  for (const SceneSizes& sizes : bench.scenes)
    if (!std::is_sorted(sizes.bodies.begin(), sizes.bodies.end(), std::less_equal<int>()))
      throw InputError("numbers of bodies must grow, from few to many");
  if (bench.scenes.empty() && !bench.engine_solvers.empty())
    throw InputError("the engine's solvers take scenes, not problems from files; name a scene");
}

sim::LocalSolveSettings settings_of(const SolverBench& bench, sim::LocalSolver solver) {
  sim::LocalSolveSettings settings = bench.settings;
  settings.solver = solver;
  settings.tolerance = bench.tolerances.back();
  return settings;
}

/// Runs as they end.
class Runs {
 public:
  explicit Runs(const SolverBenchWatch& watch) : watch_(watch) {}

  void begin(const std::string& what) const {
    stop_if_cancelled();
    watch_.begins(what);
  }
  void add(SolverRun run) {
    runs_.push_back(std::move(run));
    watch_.ended(runs_.back());
  }
  std::vector<SolverRun> all() && { return std::move(runs_); }

 private:
  const SolverBenchWatch& watch_;
  std::vector<SolverRun> runs_;
};

class SceneRuns {
 public:
  SceneRuns(const SolverBench& bench, StepScene scene, Runs& runs) : bench_(bench), scene_(scene), runs_(runs) {}

  void run(int bodies) {
    runs_.begin("settling " + step_scene_names()[std::size_t(scene_)] + " " + std::to_string(bodies));
    const SceneStep step = settled_step(scene_, bodies, bench_.threads, bench_.backend);
    const sim::StepProblem problem = step_problem(step, bench_.most_whole);
    for (const sim::LocalSolver solver : bench_.solvers) {
      sim::LocalSolveSettings settings = settings_of(bench_, solver);
      if (bench_.is_warm && sim::takes_start(solver)) settings.start = warm_start(step, problem);
      add(sim::solver_name(solver), step, problem,
          [&] { return run_solver(step.name, problem.local(), settings, &problem); });
    }
    for (const sim::Solver solver : bench_.engine_solvers)
      add(engine_run_name(solver), step, problem,
          [&] { return engine_run(step, problem, solver, bench_.settings, bench_.threads, bench_.backend); });
  }

 private:
  template <class Run>
  void add(const std::string& solver, const SceneStep& step, const sim::StepProblem& problem, Run run) {
    runs_.begin(step.name + ", " + solver);
    SolverRun done;
    if (const double taken = taken_[solver]; taken > bench_.skip_after)
      done = {.problem = step.name,
              .solver = solver,
              .refusal = solver + " was not run, since fewer bodies took it " + number_text(taken) + " s",
              .contacts = problem.local().contact_count(),
              .error = kNever};
    else
      done = run();
    if (!done.trace.empty()) taken_[solver] = done.trace.back().seconds;
    done.scene = step_scene_names()[std::size_t(scene_)];
    done.bodies = step.bodies;
    runs_.add(std::move(done));
  }

  const SolverBench& bench_;
  StepScene scene_;
  Runs& runs_;
  std::map<std::string, double> taken_;  // by solver, at the latest size [s]
};

}  // namespace

double SolverRun::seconds_to(double tolerance) const {
  return first_at(*this, tolerance, [](const sim::TracePoint& p) { return p.seconds; });
}
double SolverRun::iterations_to(double tolerance) const {
  return first_at(*this, tolerance, [](const sim::TracePoint& p) { return double(p.iteration); });
}

std::vector<std::string> run_names(const SolverBench& bench) {
  std::vector<std::string> names;
  for (const sim::LocalSolver solver : bench.solvers) names.push_back(sim::solver_name(solver));
  for (const sim::Solver solver : bench.engine_solvers) names.push_back(engine_run_name(solver));
  return names;
}

std::size_t run_count(const SolverBench& bench) {
  std::size_t problems = bench.files.size();
  for (const SceneSizes& sizes : bench.scenes) problems += sizes.bodies.size();
  return problems * run_names(bench).size();
}

std::vector<SolverRun> bench_solvers(const SolverBench& bench, const SolverBenchWatch& watch) {
  check(bench);
  Runs runs(watch);
  for (const auto& file : bench.files) {
    const sim::LocalProblem problem = sim::read_problem(file);
    for (const sim::LocalSolver solver : bench.solvers) {
      runs.begin(file.filename().string() + ", " + sim::solver_name(solver));
      runs.add(run_solver(file.filename().string(), problem, settings_of(bench, solver), nullptr));
    }
    for (const sim::Solver solver : bench.engine_solvers)
      runs.add({.problem = file.filename().string(),
                .solver = engine_run_name(solver),
                .refusal = engine_run_name(solver) + " refuses a problem from a file; it takes scenes",
                .contacts = problem.contact_count(),
                .error = kNever});
  }
  for (const SceneSizes& sizes : bench.scenes) {
    SceneRuns scene_runs(bench, sizes.scene, runs);
    for (const int bodies : sizes.bodies) scene_runs.run(bodies);
  }
  return std::move(runs).all();
}

Profile time_profile(const SolverBench& bench, const std::vector<SolverRun>& runs, double tolerance) {
  constexpr double kClock = 1e-6;  // s: shorter times are the clock's noise
  const std::size_t count = run_names(bench).size();
  std::vector<std::vector<double>> cost(count);
  for (std::size_t k = 0; k < runs.size(); ++k)
    cost[k % count].push_back(std::max(runs[k].seconds_to(tolerance), kClock));
  return performance_profile(cost);
}

}  // namespace gonogo::lab
