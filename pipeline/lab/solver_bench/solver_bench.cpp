#include "pipeline/lab/solver_bench/solver_bench.h"

#include <limits>

#include "base/error.h"
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

SolverRun run_solver(const std::string& name, const sim::LocalProblem& problem, sim::LocalSolveSettings settings) {
  settings.keeps_trace = true;
  const sim::LocalSolution x = sim::solve(problem, settings);
  return {.problem = name,
          .solver = sim::solver_name(settings.solver),
          .refusal = x.refusal,
          .contacts = problem.contact_count(),
          .iterations = x.iterations,
          .error = x.error,
          .linear = x.linear,
          .trace = x.trace};
}

}  // namespace

double SolverRun::seconds_to(double tolerance) const {
  return first_at(*this, tolerance, [](const sim::TracePoint& p) { return p.seconds; });
}
double SolverRun::iterations_to(double tolerance) const {
  return first_at(*this, tolerance, [](const sim::TracePoint& p) { return double(p.iteration); });
}

std::vector<SolverRun> bench_solvers(const SolverBench& bench, const std::function<void()>& before_each) {
  for (std::size_t k = 0; k + 1 < bench.tolerances.size(); ++k)
    if (!(bench.tolerances[k] > bench.tolerances[k + 1])) throw InputError("tolerances must fall, from coarse to fine");
  std::vector<SolverRun> runs;
  for (const auto& file : bench.files) {
    const sim::LocalProblem problem = sim::read_problem(file);
    for (const sim::LocalSolver solver : bench.solvers) {
      before_each();
      sim::LocalSolveSettings settings = bench.settings;
      settings.solver = solver;
      settings.tolerance = bench.tolerances.back();
      runs.push_back(run_solver(file.filename().string(), problem, settings));
    }
  }
  return runs;
}

Profile time_profile(const SolverBench& bench, const std::vector<SolverRun>& runs, double tolerance) {
  constexpr double kClock = 1e-6;  // s: shorter times are the clock's noise
  std::vector<std::vector<double>> cost(bench.solvers.size());
  for (std::size_t k = 0; k < runs.size(); ++k)
    cost[k % bench.solvers.size()].push_back(std::max(runs[k].seconds_to(tolerance), kClock));
  return performance_profile(cost);
}

}  // namespace gonogo::lab
