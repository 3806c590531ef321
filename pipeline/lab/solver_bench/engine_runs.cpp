#include "pipeline/lab/solver_bench/engine_runs.h"

#include <chrono>
#include <ctime>

#include "base/cancel.h"

namespace gonogo::lab {

namespace {

/// Of the processor, or by the clock where a GPU works.
double seconds_now(sim::Backend backend) {
  if (backend == sim::Backend::cpu) return double(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::string engine_run_name(sim::Solver solver) {
  constexpr const char* kNames[] = {"apgd", "jacobi", "gauss_seidel", "bb", "jacobi_scan"};
  return std::string("engine_") + kNames[int(solver)];
}

SolverRun engine_run(const SceneStep& step, const sim::StepProblem& problem, sim::Solver solver,
                     const sim::LocalSolveSettings& settings, int threads, sim::Backend backend) {
  constexpr int kPatience = 10;  // runs without a lower error
  const sim::LocalProblem& local = problem.local();
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 10000;
  std::vector<double> best(local.q.size(), 0.0);
  SolverRun run{.problem = step.name,
                .solver = engine_run_name(solver),
                .refusal = "",
                .contacts = local.contact_count(),
                .error = sim::siconos_error(local, best, settings.target)};
  run.trace.push_back({0, 0, run.error});
  int in_vain = 0;
  for (double next = 5; next <= max && run.error > settings.tolerance && in_vain < kPatience; next *= 1.5) {
    stop_if_cancelled();
    sim::StepSettings with = step.settings;
    with.solver = solver;
    with.iterations = run.iterations = int(next);
    with.target = settings.target;
    const auto simulation = sim::make_simulation(backend, {step.world}, with, threads);
    const double start = seconds_now(backend);
    simulation->advance(1);
    const double seconds = seconds_now(backend) - start;
    const std::vector<double> r = problem.impulses(simulation->contacts(0), simulation->impulses(0));
    const double error = sim::siconos_error(local, r, settings.target);
    in_vain = error < 0.9 * run.error ? 0 : in_vain + 1;
    if (error < run.error) {
      run.error = error;
      best = r;
    }
    run.trace.push_back({run.iterations, seconds, run.error});
  }
  run.motion = problem.motion(best);
  return run;
}

}  // namespace gonogo::lab
