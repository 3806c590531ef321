// Solvers of contact problems at equal error: convergence curves, performance profiles, growth with the number of
// bodies.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/lab/solver_bench/profile.h"
#include "pipeline/lab/solver_bench/step_scenes.h"
#include "sim/local_problem/solve.h"

namespace gonogo::lab {

/// Steps of one scene at several sizes.
struct SceneSizes {
  StepScene scene;
  std::vector<int> bodies;  // increasing
};

struct SolverBench {
  std::vector<std::filesystem::path> files;
  std::vector<SceneSizes> scenes;
  std::vector<sim::LocalSolver> solvers;
  std::vector<sim::Solver> engine_solvers;              // the engine's own, on scenes, from a cold start
  std::vector<double> tolerances = {1e-3, 1e-6, 1e-8};  // of siconos_error, decreasing
  sim::LocalSolveSettings settings;                     // target, limits and facets; the tolerance is the last of these
  bool is_warm = false;                                 // solvers that can, start from the step before
  double skip_after = 60;  // a solver that took longer at a size of a scene is not run at larger ones [s]
  std::size_t most_whole = sim::StepProblem::kMostWhole;  // blocks of W; with more, products go by bodies
  int threads = 1;                                        // of the engine
  sim::Backend backend = sim::Backend::cpu;               // of the engine, which also settles the scenes
};

struct SolverRun {
  std::string problem, solver, refusal;
  std::string scene = {};  // empty for a file
  int bodies = 0;          // of a scene
  int contacts = 0, iterations = 0;
  double error = 0, lcp_error = 0;  // lcp_error: of solvers with facets, otherwise 0
  sim::StepMotion motion = {};      // at the end of the step; of a scene
  sim::LinearWork linear = {};
  std::vector<sim::TracePoint> trace = {};

  /// Processor seconds and iterations until the error was at `tolerance`; infinite when it never was.
  double seconds_to(double tolerance) const;
  double iterations_to(double tolerance) const;
};

/// Names in the order of the runs of each problem: the solvers, then "engine_" and the name of each of the engine's
/// where there are scenes.
std::vector<std::string> run_names(const SolverBench& bench);

/// What a caller is told while a bench goes on.
struct SolverBenchWatch {
  std::function<void(const std::string& what)> begins = [](const std::string&) {};  // settling a scene, or a run
  std::function<void(const SolverRun&)> ended = [](const SolverRun&) {};
};

/// Problems times solvers.
std::size_t run_count(const SolverBench& bench);

/// Runs of all solvers on all problems, problem by problem; every problem has the same number of runs, in the order of
/// run_names(). Throws InputError for malformed files, tolerances that do not fall and sizes that do not grow. Throws
/// Cancelled when the user asked to stop; `watch` has seen the runs that ended.
std::vector<SolverRun> bench_solvers(const SolverBench& bench, const SolverBenchWatch& watch = {});

/// Of the seconds to `tolerance`; solvers in the order of run_names().
Profile time_profile(const SolverBench& bench, const std::vector<SolverRun>& runs, double tolerance);

/// cost = factor * bodies^exponent, by least squares of the logarithms.
struct Growth {
  std::string scene, solver;
  double tolerance = 0;
  int sizes = 0;  // at which the tolerance was reached; below 2 the exponents are NaN
  double seconds_exponent = 0, iterations_exponent = 0;
};
/// Over all sizes of each scene.
std::vector<Growth> growth(const SolverBench& bench, const std::vector<SolverRun>& runs);

/// The same over contacts, of what the linear systems took: bytes, set-up and solution in processor time, rank. NaN
/// where fewer than two sizes have any.
struct LinearGrowth {
  std::string scene, solver;
  double bytes_exponent = 0, setup_exponent = 0, solve_exponent = 0, rank_exponent = 0;
};
/// Of solvers that keep factors.
std::vector<LinearGrowth> linear_growth(const SolverBench& bench, const std::vector<SolverRun>& runs);

/// The table of the runs so far: times.csv in `folder`, which is created.
void write_solver_times(const std::filesystem::path& folder, const SolverBench& bench,
                        const std::vector<SolverRun>& runs);
/// The errors over iterations and time of the runs so far: curves.csv.
void write_solver_curves(const std::filesystem::path& folder, const std::vector<SolverRun>& runs);

/// Of all runs: writes curves.csv, profile.csv, times.csv, and with cairo profile.png and two curves per problem (over
/// time and over iterations), into `folder`, which is created. For scenes also growth.csv with its plots, linear.csv,
/// and motion.csv: momentum and kinetic energy, which all solvers must agree on.
void write_solver_bench(const std::filesystem::path& folder, const SolverBench& bench,
                        const std::vector<SolverRun>& runs);

}  // namespace gonogo::lab
