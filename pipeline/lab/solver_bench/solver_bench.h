// Solvers of contact problems at equal error: convergence curves and performance profiles.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/lab/solver_bench/profile.h"
#include "sim/local_problem/solve.h"

namespace gonogo::lab {

struct SolverBench {
  std::vector<std::filesystem::path> files;
  std::vector<sim::LocalSolver> solvers;
  std::vector<double> tolerances = {1e-3, 1e-6, 1e-8};  // of siconos_error, decreasing
  sim::LocalSolveSettings settings;                     // target, limits and facets; the tolerance is the last of these
};

struct SolverRun {
  std::string problem, solver, refusal;
  int contacts = 0, iterations = 0;
  double error = 0;
  sim::LinearWork linear;
  std::vector<sim::TracePoint> trace;

  /// Seconds and iterations until the error was at `tolerance`; infinite when it never was.
  double seconds_to(double tolerance) const;
  double iterations_to(double tolerance) const;
};

/// Runs of all solvers on all files, file by file. `before_each`: called before every run. Throws InputError for
/// malformed files and tolerances that do not fall.
std::vector<SolverRun> bench_solvers(const SolverBench& bench, const std::function<void()>& before_each);

/// Of the seconds to `tolerance`; solvers in the order of the bench.
Profile time_profile(const SolverBench& bench, const std::vector<SolverRun>& runs, double tolerance);

/// Writes curves.csv, profile.csv, times.csv, and with cairo profile.png and a curve per problem, into `folder`, which
/// is created.
void write_solver_bench(const std::filesystem::path& folder, const SolverBench& bench,
                        const std::vector<SolverRun>& runs);

}  // namespace gonogo::lab
