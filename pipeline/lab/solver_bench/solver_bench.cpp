#include "pipeline/lab/solver_bench/solver_bench.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

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

class SceneRuns {
 public:
  SceneRuns(const SolverBench& bench, const std::function<void()>& before_each, std::vector<SolverRun>& runs)
      : bench_(bench), before_each_(before_each), runs_(runs) {}

  void run(StepScene scene, int bodies) {
    const SceneStep step = settled_step(scene, bodies, bench_.threads);
    const sim::StepProblem problem = step_problem(step);
    const std::size_t first = runs_.size();
    for (const sim::LocalSolver solver : bench_.solvers) {
      sim::LocalSolveSettings settings = settings_of(bench_, solver);
      if (bench_.is_warm && sim::takes_start(solver)) settings.start = warm_start(step, problem);
      add(sim::solver_name(solver), step, problem,
          [&] { return run_solver(step.name, problem.local(), settings, &problem); });
    }
    for (const sim::Solver solver : bench_.engine_solvers)
      add(engine_run_name(solver), step, problem,
          [&] { return engine_run(step, problem, solver, bench_.settings, bench_.threads); });
    for (std::size_t k = first; k < runs_.size(); ++k) {
      runs_[k].scene = step_scene_names()[std::size_t(scene)];
      runs_[k].bodies = step.bodies;
    }
  }

 private:
  template <class Run>
  void add(const std::string& solver, const SceneStep& step, const sim::StepProblem& problem, Run run) {
    before_each_();
    if (const double taken = taken_[solver]; taken > bench_.skip_after) {
      runs_.push_back({.problem = step.name,
                       .solver = solver,
                       .refusal = solver + " was not run, since fewer bodies took it " + number_text(taken) + " s",
                       .contacts = problem.local().contact_count(),
                       .error = kNever});
      return;
    }
    runs_.push_back(run());
    if (!runs_.back().trace.empty()) taken_[solver] = runs_.back().trace.back().seconds;
  }

  const SolverBench& bench_;
  const std::function<void()>& before_each_;
  std::vector<SolverRun>& runs_;
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

std::vector<SolverRun> bench_solvers(const SolverBench& bench, const std::function<void()>& before_each) {
  check(bench);
  std::vector<SolverRun> runs;
  for (const auto& file : bench.files) {
    const sim::LocalProblem problem = sim::read_problem(file);
    for (const sim::LocalSolver solver : bench.solvers) {
      before_each();
      runs.push_back(run_solver(file.filename().string(), problem, settings_of(bench, solver), nullptr));
    }
    for (const sim::Solver solver : bench.engine_solvers)
      runs.push_back({.problem = file.filename().string(),
                      .solver = engine_run_name(solver),
                      .refusal = engine_run_name(solver) + " refuses a problem from a file; it takes scenes",
                      .contacts = problem.contact_count(),
                      .error = kNever});
  }
  for (const SceneSizes& sizes : bench.scenes) {
    SceneRuns scene_runs(bench, before_each, runs);
    for (const int bodies : sizes.bodies) scene_runs.run(sizes.scene, bodies);
  }
  return runs;
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
